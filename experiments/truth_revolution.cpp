// Truth for surfaces of revolution about y with a polynomial profile: teardrop and bezier_revolution.
//
// Ray and surface become integers O, D, R(t), Y(t) in one object space; l = l' 2^e connects the two lengths.
// Rays that climb (D_y != 0) are settled by one polynomial in t, horizontal rays by circles whose radius is
// algebraic. The page experiments/truth.md has the proofs.
#include <algorithm>
#include <array>
#include <cmath>
#include <graze/experiments/truth_distance.hpp>
#include <graze/experiments/truth_frame.hpp>
#include <graze/experiments/truth_number.hpp>
#include <graze/experiments/truth_types.hpp>
#include <limits>
#include <stdexcept>

namespace graze::truth {
namespace {

/// p + c.
Polynomial plus(Polynomial p, const Integer& c) {
  if (p.empty()) p.emplace_back(0);
  p[0] += c;
  trim(p);
  return p;
}

/// Polynomials of the profile and what is formed of them, in integers times 2^e.
struct Profile {
  Polynomial r, y, r_squared, y_squared;
  long e = 0;

  [[nodiscard]] Profile times(const Integer& factor) const {
    const Integer squared = factor * factor;
    return {scaled(r, factor), scaled(y, factor), scaled(r_squared, squared), scaled(y_squared, squared), e};
  }
  [[nodiscard]] Profile at_exponent(long to) const {
    if (to == e) return *this;
    Profile p = times(shifted(Integer(1), e - to));
    p.e = to;
    return p;
  }
};

/// One ray and the profile in the same integers: X = O + l' D, l = l' 2^e.
struct Question {
  const Ray* ray = nullptr;
  Vector o, d;
  Profile profile;
  long e = 0;
};

/// A point of the ray on the surface: l, the profile's parameter, and how the ray passes.
struct Contact {
  Number l;
  Root* root;
  std::uint32_t multiplicity;
  bool pole;                 ///< R(t) = 0
  bool perpendicular;        ///< n . d = 0, proved
  int derivative_order = 1;  ///< of the first derivative of (R, Y) that is not zero; above 1 at a cusp
};

class Revolution final : public Surface {
 public:
  /// `profile.r` and `profile.y` in integers times 2^e.
  Revolution(Profile profile, const Placement& placement);

  [[nodiscard]] Answer all(const Ray& ray, const Options& options) const override;
  [[nodiscard]] double distance(Vec3 point) const override { return distance_(point); }

 private:
  [[nodiscard]] Question ask(const Ray& ray) const;
  [[nodiscard]] Answer climbing(const Question& q, int digits) const;
  [[nodiscard]] Answer horizontal(const Question& q, int digits) const;
  [[nodiscard]] Answer in_plane(const Question& q, int digits) const;
  [[nodiscard]] Answer through_plane(const Question& q, int digits) const;
  [[nodiscard]] Answer finish(const Question& q, std::vector<Contact> contacts, int digits) const;
  [[nodiscard]] Hit hit(const Question& q, Contact& contact, int digits) const;
  void set_normal(Hit& hit, const Question& q, Contact& contact) const;
  [[nodiscard]] int pole_sign(const Question& q, Root& root) const;
  [[nodiscard]] Intervals object_normal(const Question& q, Contact& contact, long bits) const;

  Profile profile_;
  Transform transform_;
  ProfileDistance distance_;
  int orientation_ = 1;
  bool is_flat_ = false;        ///< Y is constant
  bool y_is_monotone_ = false;  ///< strictly, on [0, 1]
};

/// Sign of the enclosed volume, pi times the integral of R^2 Y' over [0, 1]; 1 when it is zero.
int volume_sign(const Polynomial& r_squared, const Polynomial& y) {
  const Polynomial integrand = multiply(r_squared, derivative(y));
  Rational volume = 0;
  for (std::size_t i = 0; i < integrand.size(); ++i) volume += Rational(integrand[i], Integer(i + 1));
  return volume < 0 ? -1 : 1;
}

/// Sufficient: Y' has no root in the open interval (0, 1).
bool is_monotone(const Polynomial& y) {
  const Polynomial slope = derivative(y);
  if (slope.empty()) return false;
  for (const Root& root : roots_in_unit_interval(slope))
    if (!root.exact || root.k != 0) return false;
  return true;
}

std::vector<Quad> to_quads(const Polynomial& p, long e) {
  std::vector<Quad> quads;
  for (const Integer& c : p) quads.push_back(ldexp(Quad(c), static_cast<int>(e)));
  return quads;
}

Revolution::Revolution(Profile profile, const Placement& placement)
    : profile_(std::move(profile)), transform_(prepare(placement)) {
  trim(profile_.r);
  trim(profile_.y);
  if (profile_.r.empty()) throw std::invalid_argument("the profile lies on the axis and makes no surface");
  if (degree(profile_.r) < 1 && degree(profile_.y) < 1)
    throw std::invalid_argument("the profile is a single point and makes no surface");
  distance_ = ProfileDistance(to_quads(profile_.r, profile_.e), to_quads(profile_.y, profile_.e), placement);
  profile_.r_squared = multiply(profile_.r, profile_.r);
  profile_.y_squared = multiply(profile_.y, profile_.y);
  orientation_ = volume_sign(profile_.r_squared, profile_.y);
  is_flat_ = degree(profile_.y) < 1;
  y_is_monotone_ = is_monotone(profile_.y);
  // Object space is stretched by det M and 2^e of M, which turns M^-1 into the adjugate.
  if (!transform_.identity) {
    profile_ = profile_.times(transform_.det);
    profile_.e += transform_.e;
  }
}

Question Revolution::ask(const Ray& ray) const {
  ObjectRay object = to_object(transform_, ray);
  const bool moved = !is_zero(object.o);
  const long e = moved ? std::min(object.o_e, profile_.e) : profile_.e;
  if (moved)
    for (auto& c : object.o) c = shifted(c, object.o_e - e);
  Question q;
  q.ray = &ray;
  q.o = std::move(object.o);
  q.d = std::move(object.d);
  q.profile = profile_.at_exponent(e);
  q.e = e - object.d_e;
  return q;
}

Answer Revolution::all(const Ray& ray, const Options& options) const {
  if (auto refused = refusal(ray)) return *std::move(refused);
  const int digits = std::max(options.digits, 17);
  const Question q = ask(ray);
  const bool climbs = sign(q.d[1]) != 0;
  if (is_flat_) return climbs ? through_plane(q, digits) : in_plane(q, digits);
  return climbs ? climbing(q, digits) : horizontal(q, digits);
}

/// The height over the origin, Y(t) - O_y, turned so that it has the sign of l'.
Polynomial rise(const Question& q) {
  const Polynomial height = plus(q.profile.y, -q.o[1]);
  return sign(q.d[1]) >= 0 ? height : scaled(height, -1);
}

/// E(t) = D_y^2 R^2 - |D_xz (Y - O_y) + D_y O_xz|^2, with c = D_y O_xz - O_y D_xz.
Polynomial climbing_equation(const Question& q) {
  const auto& [ox, oy, oz] = q.o;
  const auto& [dx, dy, dz] = q.d;
  const Integer cx = dy * ox - oy * dx;
  const Integer cz = dy * oz - oy * dz;
  Polynomial e = scaled(q.profile.r_squared, dy * dy);
  e = add(e, scaled(q.profile.y_squared, -(dx * dx + dz * dz)));
  e = add(e, scaled(q.profile.y, -2 * (dx * cx + dz * cz)));
  return plus(std::move(e), -(cx * cx + cz * cz));
}

bool is_end(const Root& root) { return root.exact && (sign(root.m) == 0 || (root.k == 0 && root.m == 1)); }

/// Sign of E right beside its root at an end of [0, 1], inside the interval.
int sign_beside_end(const Polynomial& e, const Root& root) {
  Polynomial p = e;
  if (sign(root.m) != 0) {
    // t = 1 - u
    p = taylor_shift(std::move(p), 1);
    for (std::size_t i = 1; i < p.size(); i += 2) p[i] = -p[i];
  }
  for (const auto& c : p)
    if (sign(c) != 0) return sign(c);
  return 0;
}

/// l of the ray at height Y(t): (Y(t) - O_y) / D_y 2^e. Not zero.
Number length_at_height(const Question& q, Root& root) {
  const Polynomial height = rise(q);
  const Integer dy = abs(q.d[1]);
  const Integer lipschitz = lipschitz_bound(height);
  const auto enclose = [height, dy, lipschitz, e = q.e, &root](long bits) {
    const Interval top = nonzero_image(root, height, lipschitz, bits + 2);
    return times_power_of_two(top / Interval::of(dy, top.precision()), e);
  };
  const auto equals = [height, dy, e = q.e, &root](const Rational& l) {
    // l 2^-e dy = height(t), cleared of denominators.
    const Rational wanted = l * rational(dy, e);
    return vanishes_at(root, plus(scaled(height, denominator(wanted)), -numerator(wanted)));
  };
  return {enclose, equals};
}

/// l' = (-B + side sqrt(G(t))) / A for a circle met twice; not zero.
Number length_on_circle(const Integer& a, const Integer& b, const Polynomial& g, int side, long e,
                        Root& root) {
  const Integer lipschitz = lipschitz_bound(g);
  const auto enclose = [=, &root](long bits) {
    // -B and the square root may cancel: as many bits more as it takes.
    for (long more = bits + 4;; more *= 2) {
      const Interval half = sqrt(nonzero_image(root, g, lipschitz, more));
      const Interval top = (side > 0 ? half : -half) - Interval::of(b, more);
      if (top.is_relative(bits + 1)) return times_power_of_two(top / Interval::of(a, more), e);
    }
  };
  const auto equals = [=, &root](const Rational& l) {
    const Rational half = l * rational(a, e) + Rational(b);
    const Rational squared = half * half;
    if (half.sign() != side) return false;
    return vanishes_at(root, plus(scaled(g, denominator(squared)), -numerator(squared)));
  };
  return {enclose, equals};
}

/// Joins contacts at one point: their multiplicities add, the smaller t stays. `same` decides exactly.
template <class Same>
void join(std::vector<Contact>& contacts, const Same& same) {
  // 200 bits part all but the very closest before the exact test.
  constexpr long kBits = 200;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    for (std::size_t j = i + 1; j < contacts.size();) {
      const Interval& a = contacts[i].l.enclosure(kBits);
      const Interval& b = contacts[j].l.enclosure(kBits);
      if (below(a, b) || below(b, a) || !same(contacts[i], contacts[j])) {
        ++j;
        continue;
      }
      contacts[i].multiplicity += contacts[j].multiplicity;
      contacts.erase(contacts.begin() + static_cast<std::ptrdiff_t>(j));
    }
  }
}

/// Ascending l of distinct numbers: narrower enclosures until they are disjoint.
void sort_by_length(std::vector<Contact>& contacts) {
  for (long bits = 64;; bits *= 2) {
    for (Contact& contact : contacts) static_cast<void>(contact.l.enclosure(bits));
    std::sort(contacts.begin(), contacts.end(), [](const Contact& a, const Contact& b) {
      return mpfr_less_p(a.l.known().lo(), b.l.known().lo()) != 0;
    });
    const auto overlap = std::adjacent_find(
        contacts.begin(), contacts.end(),
        [](const Contact& a, const Contact& b) { return !below(a.l.known(), b.l.known()); });
    if (overlap == contacts.end()) return;
  }
}

/// Order of the first derivative of the profile that does not vanish at the root.
int first_derivative(const Profile& p, Root& root) {
  Polynomial r = derivative(p.r);
  Polynomial y = derivative(p.y);
  int order = 1;
  for (; sign_at(root, r) == 0 && sign_at(root, y) == 0; ++order) {
    r = derivative(r);
    y = derivative(y);
  }
  return order;
}

/// Multiplicity, pole and cusp of a contact; `touches` is a proof of n . d = 0 away from cusps.
Contact make_contact(const Question& q, Number l, Root& root, std::uint32_t multiplicity, bool touches) {
  Contact contact{std::move(l), &root, multiplicity, sign_at(root, q.profile.r) == 0, touches};
  // Only a multiple root can be a cusp: its derivative in t vanishes with those of R and Y.
  if (root.multiplicity >= 2) contact.derivative_order = first_derivative(q.profile, root);
  return contact;
}

Answer Revolution::climbing(const Question& q, int digits) const {
  const Polynomial e = climbing_equation(q);
  const Polynomial height = rise(q);
  if (e.empty()) {
    if (takes_positive_value(height)) return coincident_answer();
    return {};
  }
  std::vector<Root> roots = roots_in_unit_interval(e);
  std::vector<Contact> contacts;
  for (Root& root : roots) {
    if (sign_at(root, height) <= 0) continue;
    // E' = -2 D_y R n . D up to a factor, so a multiple root away from poles and cusps is a touch.
    Contact contact =
        make_contact(q, length_at_height(q, root), root, root.multiplicity, root.multiplicity >= 2);
    if (contact.pole || contact.derivative_order > 1) contact.perpendicular = false;
    if (contact.pole && is_end(root)) contact.multiplicity = sign_beside_end(e, root) > 0 ? 1 : 2;
    contacts.push_back(std::move(contact));
  }
  if (!y_is_monotone_) {
    join(contacts,
         [&](const Contact& a, const Contact& b) { return equal_images(*a.root, *b.root, height); });
  }
  return finish(q, std::move(contacts), digits);
}

Answer Revolution::horizontal(const Question& q, int digits) const {
  const Integer a = q.d[0] * q.d[0] + q.d[2] * q.d[2];
  const Integer b = q.o[0] * q.d[0] + q.o[2] * q.d[2];
  const Integer c = q.o[0] * q.o[0] + q.o[2] * q.o[2];
  // G = A R^2 + B^2 - A C is the discriminant, R^2 - C tells whether the origin is inside the circle.
  const Polynomial g = plus(scaled(q.profile.r_squared, a), b * b - a * c);
  const Polynomial outward = plus(q.profile.r_squared, -c);
  std::vector<Root> roots = roots_in_unit_interval(plus(q.profile.y, -q.o[1]));
  std::vector<Contact> contacts;
  for (Root& root : roots) {
    const int discriminant = sign_at(root, g);
    if (discriminant < 0) continue;
    const auto touch = [&](Number l, std::uint32_t multiplicity, bool touches) {
      contacts.push_back(make_contact(q, std::move(l), root, multiplicity, touches));
      if (!touches && contacts.back().derivative_order == 1)
        contacts.back().perpendicular = contacts.back().pole || root.multiplicity >= 2;
    };
    if (discriminant == 0) {
      const bool end_pole = is_end(root) && sign_at(root, q.profile.r) == 0;
      const std::uint32_t multiplicity = end_pole ? 2 : 2 * root.multiplicity;
      if (sign(b) < 0) touch(rational_length(Rational(-b, a) * rational(1, -q.e)), multiplicity, true);
      continue;
    }
    const int inside = sign_at(root, outward);
    if (sign(b) < 0 && inside < 0) touch(length_on_circle(a, b, g, -1, q.e, root), root.multiplicity, false);
    if (sign(b) < 0 || inside > 0) touch(length_on_circle(a, b, g, 1, q.e, root), root.multiplicity, false);
  }
  join(contacts, [&](const Contact& x, const Contact& y) {
    return x.root != y.root && equal_images(*x.root, *y.root, q.profile.r_squared);
  });
  return finish(q, std::move(contacts), digits);
}

Answer Revolution::through_plane(const Question& q, int digits) const {
  const Integer height = (q.profile.y.empty() ? Integer(0) : q.profile.y[0]) - q.o[1];
  if (sign(height) * sign(q.d[1]) <= 0) return {};
  std::vector<Root> roots = roots_in_unit_interval(climbing_equation(q));
  if (roots.empty()) return {};
  Root& root = roots.front();
  std::vector<Contact> contacts;
  contacts.push_back(
      make_contact(q, rational_length(Rational(height, q.d[1]) * rational(1, -q.e)), root, 1, false));
  contacts.back().derivative_order = first_derivative(q.profile, root);
  return finish(q, std::move(contacts), digits);
}

Answer Revolution::in_plane(const Question& q, int digits) const {
  if ((q.profile.y.empty() ? Integer(0) : q.profile.y[0]) != q.o[1]) return {};
  const Integer a = q.d[0] * q.d[0] + q.d[2] * q.d[2];
  const Integer b = q.o[0] * q.d[0] + q.o[2] * q.d[2];
  const Integer c = q.o[0] * q.o[0] + q.o[2] * q.o[2];
  // A ray that leaves the axis is nearest at its origin, which is not part of it.
  if (sign(b) >= 0) {
    if (takes_positive_value(plus(q.profile.r_squared, -c))) return coincident_answer();
    return {};
  }
  const Polynomial g = plus(scaled(q.profile.r_squared, a), b * b - a * c);
  if (takes_positive_value(g)) return coincident_answer();
  std::vector<Root> roots = roots_in_unit_interval(g);
  if (roots.empty()) return {};
  std::vector<Contact> contacts;
  Root& root = roots.front();
  contacts.push_back(make_contact(q, rational_length(Rational(-b, a) * rational(1, -q.e)), root, 2, true));
  contacts.back().derivative_order = first_derivative(q.profile, root);
  return finish(q, std::move(contacts), digits);
}

Answer Revolution::finish(const Question& q, std::vector<Contact> contacts, int digits) const {
  sort_by_length(contacts);
  Answer answer;
  for (Contact& contact : contacts) answer.hits.push_back(hit(q, contact, digits));
  return answer;
}

Intervals object_point(const Question& q, Number& l, long bits) {
  const Interval scaled_l = times_power_of_two(l.enclosure(bits), -q.e);
  const auto at = [&](std::size_t i) {
    return Interval::of(q.o[i], bits) + scaled_l * Interval::of(q.d[i], bits);
  };
  return {at(0), at(1), at(2)};
}

/// atan2(z, x); a coordinate that may be zero at this precision counts as zero.
double angle(const Intervals& x) {
  const auto part = [](const Interval& a, long& e) {
    e = a.contains_zero() ? std::numeric_limits<long>::min() : mpfr_get_exp(a.lo());
  };
  long ex = 0;
  long ez = 0;
  part(x[0], ex);
  part(x[2], ez);
  const long top = std::max(ex, ez);
  if (top == std::numeric_limits<long>::min()) return 0;
  const auto size = [top](const Interval& a) {
    return a.contains_zero() ? 0.0 : times_power_of_two(a, -top).middle();
  };
  return std::atan2(size(x[2]), size(x[0]));
}

/// The y component, 1 or -1, of the normal where the profile meets the axis: |R| grows away from the first
/// end and falls towards the last. Within the profile, where it meets the axis in a double tip, that of -R'.
int Revolution::pole_sign(const Question& q, Root& root) const {
  if (is_end(root)) return sign(root.m) == 0 ? -orientation_ : orientation_;
  const int slope = sign_at(root, derivative(q.profile.r));
  return slope == 0 ? orientation_ : -slope * orientation_;
}

/// (Y', -|R|') in the half plane (|R|, y), times |R|: (Y' X, -R R', Y' Z), oriented outward, of any length.
/// At a pole (0, +-1, 0).
Intervals Revolution::object_normal(const Question& q, Contact& contact, long bits) const {
  const auto whole = [bits](int value) { return Interval::of(Integer(value), bits); };
  if (contact.pole) return {whole(0), whole(pole_sign(q, *contact.root)), whole(0)};
  Polynomial dr = q.profile.r;
  Polynomial dy = q.profile.y;
  for (int i = 0; i < contact.derivative_order; ++i) {
    dr = derivative(dr);
    dy = derivative(dy);
  }
  const auto at_root = [&](const Polynomial& p) { return image(*contact.root, p, lipschitz_bound(p), bits); };
  const Intervals x = object_point(q, contact.l, bits);
  const Interval r = nonzero_image(*contact.root, q.profile.r, lipschitz_bound(q.profile.r), bits);
  const Interval side = whole(orientation_);
  const Interval outward = side * at_root(dy);
  return {outward * x[0], -(side * r * at_root(dr)), outward * x[2]};
}

void Revolution::set_normal(Hit& hit, const Question& q, Contact& contact) const {
  // A cusp's normal may be perpendicular to the ray without proof; 2048 bits are then taken for zero.
  constexpr long kCuspBits = 2048;
  const auto normal = [&](long bits) {
    refine(*contact.root, bits);
    return to_world(transform_, object_normal(q, contact, bits), bits);
  };
  const long most_bits = contact.derivative_order > 1 ? kCuspBits : std::numeric_limits<long>::max();
  truth::set_normal(hit, q.ray->d, normal, contact.perpendicular, most_bits);
}

Hit Revolution::hit(const Question& q, Contact& contact, int digits) const {
  Hit hit;
  hit.l = to_real(contact.l, digits);
  hit.multiplicity = contact.multiplicity;
  hit.tangent = contact.multiplicity >= 2;
  hit.point = point_at(*q.ray, contact.l);
  Number t = number_of(*contact.root);
  hit.params[0] = nearest(t, 0, 64);
  hit.params[1] = contact.pole ? 0 : angle(object_point(q, contact.l, 128));
  set_normal(hit, q, contact);
  return hit;
}

/// Power basis of a Bezier polynomial: c_k = C(n,k) sum_j (-1)^(k-j) C(k,j) p_j.
Polynomial from_bezier(const std::vector<Integer>& points) {
  std::vector<Integer> difference = points;
  Polynomial p;
  Integer binomial = 1;
  const std::size_t n = points.size() - 1;
  for (std::size_t k = 0; k <= n; ++k) {
    p.push_back(binomial * difference[0]);
    for (std::size_t j = 0; j + k < n; ++j) difference[j] = difference[j + 1] - difference[j];
    binomial = binomial * (n - k) / (k + 1);
  }
  trim(p);
  return p;
}

}  // namespace

std::unique_ptr<Surface> make_teardrop(const SurfaceSpec& spec) {
  constexpr std::array<std::string_view, 1> kNames{"s"};
  spec.parameters.expect_only(kNames, "teardrop");
  const double s = spec.parameters.number("s");
  if (!std::isfinite(s) || s <= 0) throw std::invalid_argument("s must be a positive number");
  const Dyadic size = exact(s);
  const Integer m(size.m);
  Profile profile;
  profile.r = {0, 6 * m, -3 * m, -3 * m};
  profile.y = {0, 0, 6 * m};
  profile.e = size.e;
  return std::make_unique<Revolution>(std::move(profile), spec.placement);
}

std::unique_ptr<Surface> make_bezier_revolution(const SurfaceSpec& spec) {
  constexpr std::array<std::string_view, 1> kNames{"control_points"};
  spec.parameters.expect_only(kNames, "bezier_revolution");
  const auto points = spec.parameters.table("control_points", 2);
  if (points.size() < 2) throw std::invalid_argument("control_points needs at least two points");
  CommonExponent common;
  for (const auto& point : points) {
    if (!std::isfinite(point[0]) || !std::isfinite(point[1]))
      throw std::invalid_argument("control_points has an entry that is not finite");
    common.see(point[0]);
    common.see(point[1]);
  }
  std::vector<Integer> r;
  std::vector<Integer> y;
  for (const auto& point : points) {
    r.push_back(common(point[0]));
    y.push_back(common(point[1]));
  }
  Profile profile;
  profile.r = from_bezier(r);
  profile.y = from_bezier(y);
  profile.e = common.e();
  return std::make_unique<Revolution>(std::move(profile), spec.placement);
}

}  // namespace graze::truth
