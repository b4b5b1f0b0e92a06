// Truth for surfaces f(x, y, z) = 0 with a polynomial f: sphere, ellipsoid, quadric, torus,
// implicit_polynomial.
//
// f is exact over the rationals. On the ray it becomes an integer polynomial in l', with l = l' 2^e, whose
// positive roots are the hits. The page experiments/truth.md has the details.
#include <algorithm>
#include <array>
#include <cmath>
#include <graze/experiments/truth_foot_point.hpp>
#include <graze/experiments/truth_frame.hpp>
#include <graze/experiments/truth_number.hpp>
#include <graze/experiments/truth_types.hpp>
#include <limits>
#include <map>
#include <stdexcept>

namespace graze::truth {
namespace {

using Exponents = std::array<int, 3>;

int total_degree(const Exponents& powers) { return powers[0] + powers[1] + powers[2]; }

/// A polynomial in x, y, z with dyadic coefficients, as its definition writes it.
class Form {
 public:
  Form() = default;
  explicit Form(const Rational& c) { add({0, 0, 0}, c); }
  /// x, y or z.
  static Form variable(std::size_t axis) {
    Form f;
    Exponents powers{};
    powers[axis] = 1;
    f.add(powers, 1);
    return f;
  }
  void add(const Exponents& powers, const Rational& c) {
    Rational& sum = terms_[powers];
    sum += c;
    if (sum.is_zero()) terms_.erase(powers);
  }
  /// Without zero coefficients, in ascending order of the powers.
  [[nodiscard]] const std::map<Exponents, Rational>& terms() const { return terms_; }
  [[nodiscard]] int degree() const {
    int most = terms_.empty() ? -1 : 0;
    for (const auto& [powers, c] : terms_) most = std::max(most, total_degree(powers));
    return most;
  }
  [[nodiscard]] Form derivative(std::size_t axis) const {
    Form f;
    for (const auto& [powers, c] : terms_) {
      if (powers[axis] == 0) continue;
      Exponents lower = powers;
      --lower[axis];
      f.add(lower, c * powers[axis]);
    }
    return f;
  }

  friend Form operator+(Form a, const Form& b) {
    for (const auto& [powers, c] : b.terms_) a.add(powers, c);
    return a;
  }
  friend Form operator-(Form a, const Form& b) {
    for (const auto& [powers, c] : b.terms_) a.add(powers, -c);
    return a;
  }
  friend Form operator*(const Form& a, const Form& b) {
    Form product;
    for (const auto& [p, c] : a.terms_)
      for (const auto& [q, d] : b.terms_) product.add({p[0] + q[0], p[1] + q[1], p[2] + q[2]}, c * d);
    return product;
  }
  friend Form operator*(const Rational& c, const Form& f) { return Form(c) * f; }

 private:
  std::map<Exponents, Rational> terms_;
};

/// c 2^e x^i y^j z^k.
struct Term {
  Integer c;
  long e = 0;
  Exponents powers{};
};

/// The terms of S^n f(X / S), S = det 2^e of the placement, n >= degree f: what f is for the stretched
/// coordinates of ObjectRay. Descending in the powers.
std::vector<Term> stretched(const Form& f, int n, const Transform& transform) {
  std::vector<Integer> power{1};
  for (int i = 0; i < n; ++i) power.push_back(power.back() * transform.det);
  std::vector<Term> terms;
  for (const auto& [powers, c] : f.terms()) {
    // The denominator of a dyadic number is a power of two.
    const int missing = n - total_degree(powers);
    const long e = 1 - bits(denominator(c)) + transform.e * missing;
    terms.push_back({numerator(c) * power[static_cast<std::size_t>(missing)], e, powers});
  }
  std::reverse(terms.begin(), terms.end());
  return terms;
}

/// One ray in integers: the stretched point is (o + l' d) 2^e, and l = l' 2^l_e.
struct Question {
  const Ray* ray = nullptr;
  Vector o, d;
  long e = 0;
  long l_e = 0;
};

/// p(l') 2^e.
struct OnRay {
  Polynomial p;
  long e = 0;
};

/// p (o + d l').
Polynomial times_linear(const Polynomial& p, const Integer& o, const Integer& d) {
  if (p.empty()) return p;
  Polynomial product(p.size() + 1);
  for (std::size_t i = 0; i < p.size(); ++i) {
    product[i] += p[i] * o;
    product[i + 1] = p[i] * d;
  }
  return product;
}

/// Horner's rule in x, y, z one inside the other, each of them a linear polynomial in l'.
class Restriction {
 public:
  Restriction(const std::vector<Term>& terms, const Question& q) : terms_(terms), q_(q) {}

  [[nodiscard]] OnRay operator()() {
    if (terms_.empty()) return {};
    const auto exponent = [this](const Term& term) { return term.e + q_.e * total_degree(term.powers); };
    long least = exponent(terms_.front());
    for (const Term& term : terms_) least = std::min(least, exponent(term));
    for (const Term& term : terms_) c_.push_back(shifted(term.c, exponent(term) - least));
    OnRay f{nested(0, terms_.size(), 0), least};
    trim(f.p);
    return f;
  }

 private:
  /// The terms first..last - 1, which agree in the powers before `axis`, without those powers.
  [[nodiscard]] Polynomial nested(std::size_t first, std::size_t last, std::size_t axis) const {
    if (axis == 3) return {c_[first]};
    Polynomial sum;
    while (first < last) {
      const int power = terms_[first].powers[axis];
      std::size_t next = first;
      while (next < last && terms_[next].powers[axis] == power) ++next;
      sum = add(sum, nested(first, next, axis + 1));
      const int lower = next < last ? terms_[next].powers[axis] : 0;
      for (int i = power; i > lower; --i) sum = times_linear(sum, q_.o[axis], q_.d[axis]);
      first = next;
    }
    return sum;
  }

  const std::vector<Term>& terms_;
  const Question& q_;
  std::vector<Integer> c_;
};

OnRay restricted(const std::vector<Term>& terms, const Question& q) { return Restriction(terms, q)(); }

/// A hit in the making: the root and the number l' that it is.
struct Contact {
  Root* root;
  Number position;
};

/// f at x by Horner's rule.
Interval evaluate(const OnRay& f, const Interval& x) {
  Interval sum = Interval::of(Integer(0), x.precision());
  for (std::size_t i = f.p.size(); i-- > 0;) sum = sum * x + Interval::of(f.p[i], x.precision());
  return times_power_of_two(std::move(sum), f.e);
}

/// f at the contact to 60 bits of itself; zero is decided exactly.
Interval settled(const OnRay& f, Contact& contact) {
  bool asked = false;
  for (long bits = 128;; bits *= 2) {
    Interval value = evaluate(f, contact.position.enclosure(bits));
    if (value.is_relative(60)) return value;
    if (!asked && vanishes_at(*contact.root, f.p)) return Interval::of(Integer(0), bits);
    asked = true;
  }
}

/// atan2 of two numbers known to 60 bits of themselves.
double angle(const Interval& y, const Interval& x) {
  constexpr long kNone = std::numeric_limits<long>::min();
  const auto exponent = [](const Interval& a) { return a.is_zero() ? kNone : mpfr_get_exp(a.lo()); };
  const long top = std::max(exponent(y), exponent(x));
  if (top == kNone) return 0;
  return std::atan2(times_power_of_two(y, -top).middle(), times_power_of_two(x, -top).middle());
}

/// Angles about a vertical axis: atan2(z, x) and atan2(y, hypot(x, z) - tube), coordinates from `center`.
struct Chart {
  Vec3 center;
  double tube = 0;
};

class Algebraic final : public Surface {
 public:
  Algebraic(const Form& f, const Placement& placement, std::optional<Chart> chart = std::nullopt);

  [[nodiscard]] Answer all(const Ray& ray, const Options& options) const override;
  [[nodiscard]] double distance(Vec3 point) const override;

 private:
  [[nodiscard]] Question ask(const Ray& ray) const;
  void add_points(const Ray& line, std::vector<WidePoint>& points) const;
  [[nodiscard]] Hit hit(const Question& q, Root& root, int digits) const;
  void set_normal(Hit& hit, const Question& q, Contact& contact) const;
  [[nodiscard]] std::array<double, 2> angles(const Question& q, Contact& contact) const;
  [[nodiscard]] OnRay from_center(const Question& q, std::size_t axis) const;

  Transform transform_;
  std::vector<Term> f_;
  std::array<std::vector<Term>, 3> gradient_;
  std::optional<Chart> chart_;
  FootPointDistance distance_;
};

std::vector<FootPointDistance::Term> to_wide(const Form& f) {
  std::vector<FootPointDistance::Term> terms;
  for (const auto& [powers, c] : f.terms())
    terms.push_back({Wide(Wide(numerator(c)) / Wide(denominator(c))), powers});
  return terms;
}

Algebraic::Algebraic(const Form& f, const Placement& placement, std::optional<Chart> chart)
    : transform_(prepare(placement)), chart_(chart), distance_(to_wide(f), placement) {
  const int n = f.degree();
  f_ = stretched(f, n, transform_);
  for (std::size_t axis = 0; axis < 3; ++axis) gradient_[axis] = stretched(f.derivative(axis), n, transform_);
}

Question Algebraic::ask(const Ray& ray) const {
  ObjectRay object = to_object(transform_, ray);
  Question q;
  q.ray = &ray;
  q.e = is_zero(object.o) ? 0 : object.o_e;
  q.l_e = q.e - object.d_e;
  q.o = std::move(object.o);
  q.d = std::move(object.d);
  return q;
}

Answer Algebraic::all(const Ray& ray, const Options& options) const {
  if (auto refused = refusal(ray)) return *std::move(refused);
  const Question q = ask(ray);
  const OnRay f = restricted(f_, q);
  if (f.p.empty()) return coincident_answer();
  Answer answer;
  if (truth::degree(f.p) < 1) return answer;
  for (Root& root : all_real_roots(primitive(f.p))) {
    const bool positive = root.exact ? sign(root.m) > 0 : sign(root.m) >= 0;
    if (positive) answer.hits.push_back(hit(q, root, std::max(options.digits, 17)));
  }
  return answer;
}

/// l = l' 2^e.
Number length(Root& root, long e) {
  const auto position = std::make_shared<Number>(number_of(root));
  const auto enclose = [position, e](long bits) { return times_power_of_two(position->enclosure(bits), e); };
  const auto equals = [position, e](const Rational& l) { return position->equals(l * rational(1, e)); };
  return {enclose, equals};
}

Hit Algebraic::hit(const Question& q, Root& root, int digits) const {
  Hit hit;
  Number l = length(root, q.l_e);
  hit.l = to_real(l, digits);
  hit.multiplicity = root.multiplicity;
  hit.tangent = root.multiplicity >= 2;
  hit.point = point_at(*q.ray, l);
  Contact contact{&root, number_of(root)};
  if (chart_) hit.params = angles(q, contact);
  set_normal(hit, q, contact);
  return hit;
}

void Algebraic::set_normal(Hit& hit, const Question& q, Contact& contact) const {
  std::array<OnRay, 3> gradient;
  for (std::size_t i = 0; i < 3; ++i) gradient[i] = restricted(gradient_[i], q);
  const auto zero = [&](const OnRay& f) { return vanishes_at(*contact.root, f.p); };
  // d f / d l' is the gradient times the direction, so only a multiple root can be singular or tangent.
  const bool multiple = contact.root->multiplicity >= 2;
  if (multiple && zero(gradient[0]) && zero(gradient[1]) && zero(gradient[2])) {
    const Vec3 d = q.ray->d;
    const auto facing = [d](long bits) {
      return Intervals{Interval::of(-d.x, bits), Interval::of(-d.y, bits), Interval::of(-d.z, bits)};
    };
    truth::set_normal(hit, d, facing, true);
    hit.cosine = 1;
    return;
  }
  const auto normal = [&](long bits) {
    const Interval& x = contact.position.enclosure(bits);
    const Intervals n{evaluate(gradient[0], x), evaluate(gradient[1], x), evaluate(gradient[2], x)};
    return to_world(transform_, n, bits);
  };
  truth::set_normal(hit, q.ray->d, normal, multiple);
}

/// The stretched coordinate less that of the chart's centre.
OnRay Algebraic::from_center(const Question& q, std::size_t axis) const {
  const Vec3& c = chart_->center;
  const Dyadic center = exact(std::array{c.x, c.y, c.z}[axis]);
  const long center_e = center.e + transform_.e;
  const long e = center.m == 0 ? q.e : std::min(q.e, center_e);
  OnRay x{{shifted(q.o[axis], q.e - e), shifted(q.d[axis], q.e - e)}, e};
  if (center.m != 0) x.p[0] -= shifted(transform_.det * center.m, center_e - e);
  trim(x.p);
  return x;
}

/// a b.
OnRay product(const OnRay& a, const OnRay& b) { return {multiply(a.p, b.p), a.e + b.e}; }

/// a + b.
OnRay sum(const OnRay& a, const OnRay& b) {
  if (a.p.empty() || b.p.empty()) return a.p.empty() ? b : a;
  const long e = std::min(a.e, b.e);
  const auto raised = [e](const OnRay& f) { return scaled(f.p, shifted(Integer(1), f.e - e)); };
  return {add(raised(a), raised(b)), e};
}

std::array<double, 2> Algebraic::angles(const Question& q, Contact& contact) const {
  const OnRay x = from_center(q, 0);
  const OnRay y = from_center(q, 1);
  const OnRay z = from_center(q, 2);
  const double theta = angle(settled(z, contact), settled(x, contact));
  const Interval height = settled(y, contact);
  const Dyadic tube = exact(chart_->tube);
  const Integer radius = transform_.det * tube.m;
  const long radius_e = tube.e + transform_.e;
  const OnRay squared = sum(product(x, x), product(z, z));
  bool asked = false;
  for (long bits = 128;; bits *= 2) {
    const Interval rho = sqrt(evaluate(squared, contact.position.enclosure(bits)));
    const Interval out = rho - times_power_of_two(Interval::of(radius, bits), radius_e);
    if (out.is_relative(60)) return {theta, angle(height, out)};
    // hypot(x, z) = tube where this polynomial is zero.
    const OnRay difference = sum(squared, {{Integer(-radius * radius)}, 2 * radius_e});
    if (!asked && vanishes_at(*contact.root, difference.p))
      return {theta, angle(height, Interval::of(Integer(0), bits))};
    asked = true;
  }
}

/// The points of a line on the surface, rounded to 237 bits of l.
void Algebraic::add_points(const Ray& line, std::vector<WidePoint>& points) const {
  const Question q = ask(line);
  const OnRay f = restricted(f_, q);
  if (f.p.empty()) points.push_back({Wide(line.o.x), Wide(line.o.y), Wide(line.o.z)});
  if (truth::degree(f.p) < 1) return;
  constexpr int kBits = std::numeric_limits<Wide>::digits;
  for (Root& root : all_real_roots(primitive(f.p))) {
    refine(root, bits(root.m) == 0 ? kBits : root.k + std::max(0L, kBits - bits(root.m)));
    const Wide l = ldexp(Wide(root.m), static_cast<int>(q.l_e - root.k));
    points.push_back({line.o.x + l * line.d.x, line.o.y + l * line.d.y, line.o.z + l * line.d.z});
  }
}

/// The axes and the face and space diagonals of a cube, one of each two opposite directions.
std::vector<Vec3> line_directions() {
  std::vector<Vec3> directions;
  for (const double x : {-1.0, 0.0, 1.0})
    for (const double y : {-1.0, 0.0, 1.0})
      for (const double z : {-1.0, 0.0, 1.0})
        // Nine, three and one weigh the coordinates so that opposite directions differ in sign.
        if (9 * x + 3 * y + z > 0) directions.push_back({x, y, z});
  return directions;
}

double Algebraic::distance(Vec3 point) const {
  if (const auto near = distance_.near(point)) return *near;
  // Lines along the axes and the diagonals of a cube, through the point and through the surface's centre,
  // meet the sheets around them.
  std::vector<WidePoint> starts;
  for (const Vec3 through : {point, distance_.center(point)}) {
    if (!is_finite(through)) continue;
    for (const Vec3 d : line_directions()) add_points({through, d}, starts);
  }
  return distance_.from_starts(point, starts);
}

constexpr std::array<std::size_t, 3> kAxes{0, 1, 2};

std::array<Form, 3> coordinates_from(Vec3 center) {
  const std::array<double, 3> c{center.x, center.y, center.z};
  std::array<Form, 3> x;
  for (const std::size_t i : kAxes) x[i] = Form::variable(i) - Form(rational(c[i]));
  return x;
}

Vec3 center_of(const SurfaceSpec& spec) {
  const std::vector<double> c = spec.parameters.list("center", 3, {0, 0, 0});
  return {c[0], c[1], c[2]};
}

Rational positive(const Parameters& parameters, const std::string& name) {
  const double value = parameters.number(name);
  if (value <= 0) throw std::invalid_argument(name + " must be a positive number");
  return rational(value);
}

Rational square(const Rational& a) { return a * a; }

using RationalMatrix = std::array<std::array<Rational, 3>, 3>;

/// Symmetric: equal to its own transpose.
RationalMatrix adjugate(const RationalMatrix& m) {
  RationalMatrix result;
  for (const std::size_t i : kAxes) {
    for (const std::size_t j : kAxes) {
      const std::size_t i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      result[j][i] = m[i1][j1] * m[i2][j2] - m[i1][j2] * m[i2][j1];
    }
  }
  return result;
}

/// P of (x - c)^T P^-1 (x - c) = 1.
RationalMatrix shape_of(const Parameters& parameters) {
  if (parameters.has("P") == parameters.has("semi_axes"))
    throw std::invalid_argument("an ellipsoid needs either P or semi_axes, and not both");
  RationalMatrix shape{};
  if (parameters.has("semi_axes")) {
    const std::vector<double> axes = parameters.list("semi_axes", 3);
    for (const std::size_t i : kAxes) {
      if (axes[i] <= 0) throw std::invalid_argument("semi_axes must be positive numbers");
      shape[i][i] = square(rational(axes[i]));
    }
    return shape;
  }
  const auto rows = parameters.table("P", 3);
  if (rows.size() != 3) throw std::invalid_argument("P must have three rows");
  for (const std::size_t i : kAxes) {
    for (const std::size_t j : kAxes) {
      if (rows[i][j] != rows[j][i]) throw std::invalid_argument("P is not symmetric");
      shape[i][j] = rational(rows[i][j]);
    }
  }
  return shape;
}

/// Whole exponents up to this total degree: beyond, dense polynomials outgrow any renderer's use.
constexpr int kMostDegree = 32;

int whole_exponent(double value) {
  constexpr double kMost = 1 << 20;  // more than any term needs that is cancelled by an equal one
  if (value < 0 || value != std::floor(value) || value > kMost)
    throw std::invalid_argument("terms has an exponent that is not a whole number from 0");
  return static_cast<int>(value);
}

/// Sign changes in a list, zeros left out.
int variations(const std::array<Rational, 4>& c) {
  int count = 0;
  int last = 0;
  for (const Rational& x : c) {
    if (x.is_zero()) continue;
    if (last != 0 && x.sign() != last) ++count;
    last = x.sign();
  }
  return count;
}

/// More eigenvalues of the symmetric m are negative than positive. All roots of the characteristic
/// polynomial are real, so Descartes' rule of signs counts them exactly.
bool is_mostly_negative(const RationalMatrix& m) {
  const RationalMatrix minors = adjugate(m);
  const Rational trace = m[0][0] + m[1][1] + m[2][2];
  const Rational second = minors[0][0] + minors[1][1] + minors[2][2];
  const Rational det = m[0][0] * minors[0][0] + m[0][1] * minors[1][0] + m[0][2] * minors[2][0];
  const int positive_count = variations({1, -trace, second, -det});
  const int negative_count = variations({1, trace, second, det});
  return negative_count > positive_count;
}

}  // namespace

std::unique_ptr<Surface> make_sphere(const SurfaceSpec& spec) {
  constexpr std::array<std::string_view, 2> kNames{"center", "radius"};
  spec.parameters.expect_only(kNames, "sphere");
  const Vec3 center = center_of(spec);
  const Rational radius = positive(spec.parameters, "radius");
  const auto [x, y, z] = coordinates_from(center);
  const Form f = x * x + y * y + z * z - Form(square(radius));
  return std::make_unique<Algebraic>(f, spec.placement, Chart{center});
}

std::unique_ptr<Surface> make_ellipsoid(const SurfaceSpec& spec) {
  constexpr std::array<std::string_view, 3> kNames{"center", "P", "semi_axes"};
  spec.parameters.expect_only(kNames, "ellipsoid");
  const Vec3 center = center_of(spec);
  const RationalMatrix shape = shape_of(spec.parameters);
  const RationalMatrix minors = adjugate(shape);
  const Rational det = shape[0][0] * minors[0][0] + shape[0][1] * minors[1][0] + shape[0][2] * minors[2][0];
  // Sylvester: the leading minors of P.
  if (shape[0][0] <= 0 || minors[2][2] <= 0 || det <= 0)
    throw std::invalid_argument("P is not positive definite");
  const std::array<Form, 3> x = coordinates_from(center);
  // det P times the definition: no division.
  Form f = Form(-det);
  for (const std::size_t i : kAxes)
    for (const std::size_t j : kAxes) f = f + minors[i][j] * (x[i] * x[j]);
  return std::make_unique<Algebraic>(f, spec.placement, Chart{center});
}

std::unique_ptr<Surface> make_quadric(const SurfaceSpec& spec) {
  constexpr std::array<std::string_view, 10> kNames{"A", "B", "C", "D", "E", "F", "G", "H", "I", "J"};
  spec.parameters.expect_only(kNames, "quadric");
  const auto value = [&](const char* name) { return rational(spec.parameters.number(name, 0)); };
  const Rational a = value("A"), b = value("B"), c = value("C"), d = value("D"), e = value("E"),
                 f = value("F"), g = value("G"), h = value("H"), i = value("I"), j = value("J");
  const Rational side = is_mostly_negative({{{a, b, c}, {b, e, f}, {c, f, h}}}) ? -1 : 1;
  Form form;
  const auto add = [&](const Exponents& powers, const Rational& q) { form.add(powers, side * q); };
  add({2, 0, 0}, a);
  add({0, 2, 0}, e);
  add({0, 0, 2}, h);
  add({1, 1, 0}, 2 * b);
  add({1, 0, 1}, 2 * c);
  add({0, 1, 1}, 2 * f);
  add({1, 0, 0}, 2 * d);
  add({0, 1, 0}, 2 * g);
  add({0, 0, 1}, 2 * i);
  add({0, 0, 0}, j);
  if (form.terms().empty()) throw std::invalid_argument("the coefficients A to J of a quadric are all zero");
  return std::make_unique<Algebraic>(form, spec.placement);
}

std::unique_ptr<Surface> make_torus(const SurfaceSpec& spec) {
  constexpr std::array<std::string_view, 2> kNames{"R", "r"};
  spec.parameters.expect_only(kNames, "torus");
  const Rational major = positive(spec.parameters, "R");
  const Rational minor = positive(spec.parameters, "r");
  const auto [x, y, z] = coordinates_from({});
  const Form k = x * x + y * y + z * z + Form(square(major) - square(minor));
  const Form f = k * k - 4 * square(major) * (x * x + z * z);
  return std::make_unique<Algebraic>(f, spec.placement, Chart{{}, spec.parameters.number("R")});
}

std::unique_ptr<Surface> make_implicit_polynomial(const SurfaceSpec& spec) {
  constexpr std::array<std::string_view, 1> kNames{"terms"};
  spec.parameters.expect_only(kNames, "implicit_polynomial");
  Form f;
  for (const auto& row : spec.parameters.table("terms", 4))
    f.add({whole_exponent(row[1]), whole_exponent(row[2]), whole_exponent(row[3])}, rational(row[0]));
  if (f.degree() < 1) throw std::invalid_argument("terms add up to a constant, which is no surface");
  if (f.degree() > kMostDegree)
    throw std::invalid_argument("terms have degree " + std::to_string(f.degree()) + ", more than " +
                                std::to_string(kMostDegree));
  return std::make_unique<Algebraic>(f, spec.placement);
}

}  // namespace graze::truth
