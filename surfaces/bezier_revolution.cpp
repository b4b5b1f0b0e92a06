#include <graze/surfaces/bezier_revolution.hpp>

#include <algorithm>
#include <cmath>

#include <graze/solvers/math/bernstein.hpp>

namespace graze {
namespace {

constexpr double kU = 0x1p-53;  // unit roundoff of double

// Kinds of equation that the polynomial formulation poses; the along-ray one uses the piece's index.
enum Kind : std::uint32_t { kSurface, kAxis, kCircle };  // kCircle + the piece's index

/// Value and first two derivatives of one coordinate.
template <class T>
struct Curve {
  T value, first, second;
};

template <class T>
Curve<T> evaluate_curve(std::span<const double> b, T t) {
  std::array<T, BezierRevolution::kMaxPoints> work;
  std::transform(b.begin(), b.end(), work.begin(), [](double v) { return static_cast<T>(v); });
  const auto n = static_cast<T>(b.size() - 1);
  const T s = 1 - t;
  Curve<T> curve{work[0], 0, 0};
  // The triangle's rows of three, two and one entries hold the second derivative, the first and the value.
  for (std::size_t size = b.size(); size > 1; --size) {
    if (size == 3) curve.second = n * (n - 1) * (work[2] - 2 * work[1] + work[0]);
    if (size == 2) curve.first = n * (work[1] - work[0]);
    for (std::size_t i = 0; i + 1 < size; ++i) work[i] = s * work[i] + t * work[i + 1];
  }
  curve.value = work[0];
  return curve;
}

/// A range of sum b_i B_i over [0, 1], tight to about 4^-kLevels: the hull of subdivided control values.
Interval tight_range(std::span<const double> b, int levels) {
  if (levels == 0) return bernstein_range(b, {});
  std::array<double, BezierRevolution::kMaxPoints> left, right, left_error, right_error;
  const std::size_t size = b.size();
  const auto part = [size](auto& array) { return std::span<double>(array.data(), size); };
  bernstein_subdivide(b, {}, 0.5, part(left), part(left_error), part(right), part(right_error));
  // The subdivision's rounding is far below the margin that the clip adds to the bounds.
  return hull(tight_range(part(left), levels - 1), tight_range(part(right), levels - 1));
}

/// Isolates the sign changes of Y' in (0, 1) by bisection of its Bernstein coefficients: exact zeros and
/// touching ones, which change no direction, need not be found. Each is returned with its uncertainty.
void find_turns(std::span<const double> c, std::span<const double> c_error, Interval t, int depth,
                std::vector<Interval>& turns) {
  const SignVariations variations = sign_variations(c, c_error);
  if (variations.upper == 0) return;
  constexpr int kDepth = 50;  // below 2^-50 of the profile a turn is a point
  if (depth == kDepth) {
    if (turns.empty() || turns.back().hi < t.lo) {
      turns.push_back(t);
    } else {
      turns.back().hi = t.hi;
    }
    return;
  }
  std::array<double, BezierRevolution::kMaxPoints> left, right, left_error, right_error;
  const std::size_t size = c.size();
  const auto part = [size](auto& array) { return std::span<double>(array.data(), size); };
  bernstein_subdivide(c, c_error, 0.5, part(left), part(left_error), part(right), part(right_error));
  const double middle = 0.5 * (t.lo + t.hi);
  find_turns(part(left), part(left_error), {t.lo, middle}, depth + 1, turns);
  find_turns(part(right), part(right_error), {middle, t.hi}, depth + 1, turns);
}

std::vector<MonotonePiece> monotone_pieces(const BezierProfile& profile) {
  const std::span<const double> y = profile.y;
  std::array<double, BezierRevolution::kMaxPoints> slope, slope_error;
  const std::size_t size = std::max<std::size_t>(y.size(), 2) - 1;
  bernstein_derivative(y, {}, {slope.data(), size}, {slope_error.data(), size});
  std::vector<Interval> turns;
  find_turns({slope.data(), size}, {slope_error.data(), size}, {0, 1}, 0, turns);

  std::vector<MonotonePiece> pieces;
  MonotonePiece piece;
  const auto close = [&](double t, double slack) {
    piece.t_hi = t;
    piece.slack_hi = slack;
    const double from = evaluate_curve(y, piece.t_lo).value;
    const double to = evaluate_curve(y, piece.t_hi).value;
    piece.rising = to >= from;
    piece.y_lo = std::min(from, to);
    piece.y_hi = std::max(from, to);
    if (piece.t_hi > piece.t_lo) pieces.push_back(piece);
    piece.t_lo = t;
    piece.slack_lo = slack;
  };
  for (const Interval& turn : turns) {
    if (turn.lo <= 0 || turn.hi >= 1) continue;  // at an end of the profile nothing is to be split
    close(mid(turn), width(turn));
  }
  close(1, 0);
  return pieces;
}

/// The enclosed volume's sign: integral of R^2 Y' dt over [0, 1]. The integrand has degree 3n - 1, so
/// composite midpoints on this many points leave far less than the sign needs; a volume that vanishes within
/// their error (a flat disk) counts as positive.
double volume_sign(const BezierProfile& profile) {
  constexpr int kPoints = 256;
  double sum = 0;
  for (int i = 0; i < kPoints; ++i) {
    const ProfilePoint p = profile.at((i + 0.5) / kPoints);
    sum += p.r * p.r * p.dy;
  }
  return sum < 0 ? -1.0 : 1.0;
}

// ------------------------------------------------------------------------------------------- F along the ray

/// One monotone piece's F for one ray.
struct PieceAlongRay {
  const BezierProfile* profile;
  const MonotonePiece* piece;
  LocalRay ray;
  double y_error;  ///< bound on the rounding of y and of Y(t)
  double r_error;  ///< bound on the rounding of R(t) at given t
  Interval px, py, pz, slope, curvature;

  PieceAlongRay(const BezierProfile& profile_, const MonotonePiece& piece_, const LocalRay& ray_)
      : profile(&profile_), piece(&piece_), ray(ray_) {
    const double roundings = 4 * static_cast<double>(profile->r.size()) * kU;
    const Cylinder& bounds = profile->cylinder;
    y_error = roundings * std::max(std::fabs(bounds.y_lo), std::fabs(bounds.y_hi));
    r_error = roundings * detail::largest(profile->r);
  }

  void prepare_intervals() {
    const auto [x, y, z] = recentred_point<Interval>(ray);
    px = x;
    py = y;
    pz = z;
    slope = px * ray.d.x + pz * ray.d.z;
    curvature = sqr(point(ray.d.x)) + sqr(point(ray.d.z));
  }

  /// With G = R^2 as a function of y: G' = 2 R R'/Y', G'' = (2 R'^2 + 2 R R'' - G' Y'') / Y'^2.
  template <class T>
  [[nodiscard]] BasicJet<T> jet(T delta) const {
    constexpr T kUnit = std::numeric_limits<T>::epsilon() / 2;
    // y_error and r_error count roundings of double.
    const T wider = static_cast<T>(static_cast<double>(kUnit) / kU);
    const T height_error = wider * static_cast<T>(y_error);
    const auto [x, height, z] = ray.point_at<T>(delta);
    const T dx = static_cast<T>(ray.d.x), ray_dy = static_cast<T>(ray.d.y), dz = static_cast<T>(ray.d.z);
    const T t =
        profile->invert(*piece, std::clamp(height, static_cast<T>(piece->y_lo), static_cast<T>(piece->y_hi)));
    const Curve<T> r = evaluate_curve(profile->r, t);
    const Curve<T> y = evaluate_curve(profile->y, t);
    // Where the profile runs horizontally G' is infinite; the smallest slope that rounding leaves keeps it a
    // number.
    const T floor = std::sqrt(kUnit) * height_error;
    const T dy = std::copysign(std::max(std::fabs(y.first), floor), piece->rising ? T{1} : T{-1});
    const T g1 = 2 * r.value * r.first / dy;
    const T g2 = (2 * (r.first * r.first + r.value * r.second) - g1 * y.second) / (dy * dy);
    BasicJet<T> jet;
    const T distance2 = x * x + z * z;
    jet.f = r.value * r.value - distance2;
    jet.df = g1 * ray_dy - 2 * (x * dx + z * dz);
    jet.ddf = g2 * ray_dy * ray_dy - 2 * (dx * dx + dz * dz);
    const T t_error =
        std::min(height_error / std::fabs(dy), std::sqrt(2 * height_error / std::fabs(y.second)));
    const T radius_error = wider * static_cast<T>(r_error) + std::fabs(r.first) * t_error;
    jet.f_error = (2 * std::fabs(r.value) + radius_error) * radius_error + 8 * kUnit * distance2;
    return jet;
  }

  /// The t of the piece with Y(t) in y: found in double, then widened until intervals prove the ends. Each
  /// end that cannot be proved goes to the piece's own end and its slack.
  [[nodiscard]] Interval parameter(Interval y) const {
    const bool rising = piece->rising;
    const double first = std::clamp(rising ? y.lo : y.hi, piece->y_lo, piece->y_hi);
    const double last = std::clamp(rising ? y.hi : y.lo, piece->y_lo, piece->y_hi);
    return {lower_parameter(profile->invert(*piece, first), rising ? y.lo : y.hi),
            upper_parameter(profile->invert(*piece, last), rising ? y.hi : y.lo)};
  }
  [[nodiscard]] double lower_parameter(double t, double height) const {
    const double end = std::max(0.0, piece->t_lo - piece->slack_lo);
    for (double step = 4 * kU; step < 1; step *= 16) {
      const double candidate = t - step;
      if (candidate <= end) break;
      if (lies_before(candidate, height)) return candidate;
    }
    return end;
  }
  [[nodiscard]] double upper_parameter(double t, double height) const {
    const double end = std::min(1.0, piece->t_hi + piece->slack_hi);
    for (double step = 4 * kU; step < 1; step *= 16) {
      const double candidate = t + step;
      if (candidate >= end) break;
      if (lies_after(candidate, height)) return candidate;
    }
    return end;
  }
  [[nodiscard]] bool lies_before(double t, double height) const {
    const Interval y = bernstein_evaluate(profile->y, {}, point(t));
    return piece->rising ? y.hi < height : y.lo > height;
  }
  [[nodiscard]] bool lies_after(double t, double height) const {
    const Interval y = bernstein_evaluate(profile->y, {}, point(t));
    return piece->rising ? y.lo > height : y.hi < height;
  }

  [[nodiscard]] Interval f(Interval x) const {
    const Interval t = parameter(py + point(ray.d.y) * x);
    const Interval r = bernstein_evaluate(profile->r, {}, t);
    return sqr(r) - sqr(px + point(ray.d.x) * x) - sqr(pz + point(ray.d.z) * x);
  }
  [[nodiscard]] Interval df(Interval x) const {
    const Interval outside = point(2) * (slope + curvature * x);
    if (ray.d.y == 0) return -outside;
    const Interval t = parameter(py + point(ray.d.y) * x);
    const Interval r = bernstein_evaluate(profile->r, {}, t);
    const Interval dr = bernstein_evaluate_derivative(profile->r, {}, t);
    const Interval dy = bernstein_evaluate_derivative(profile->y, {}, t);
    return point(2) * r * dr / dy * point(ray.d.y) - outside;
  }
};

/// The delta range in which the ray's height lies in the piece's, within [ray.lo, ray.hi].
bool piece_range(const MonotonePiece& piece, const LocalRay& ray, double& lo, double& hi) {
  lo = ray.lo;
  hi = ray.hi;
  return revolution::clip_slab(ray, {0, piece.y_lo, piece.y_hi}, lo, hi);
}

/// The regions on a piece as deltas of this ray, ascending.
Epsilons epsilons_along(const BezierRegions& regions, const BezierProfile& profile,
                        const MonotonePiece& piece, const LocalRay& ray, double unit, Arena& arena) {
  const double per_length = unit / norm(ray.d);
  const std::span<Region> parts = arena.array<Region>(BezierRegions::kParts);
  const bool upward = (ray.d.y >= 0) == piece.rising;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::size_t part = upward ? i : parts.size() - 1 - i;
    parts[i].eps = regions.eps[part] * per_length;
    if (i + 1 == parts.size()) break;  // the last part has no end
    const double t = std::clamp(BezierRegions::kEnds[upward ? part : part - 1], piece.t_lo, piece.t_hi);
    const double rise = profile.at(t).y - ray.p.y;
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const bool before = piece.rising ? rise >= 0 : rise <= 0;
    parts[i].end = ray.d.y != 0 ? rise / ray.d.y : before ? kInfinity : -kInfinity;
  }
  return {parts, regions.eps[BezierRegions::kParts] * per_length, 0x1p-9 * unit * norm(ray.d)};
}

/// Whether a solver that proves its answers is asked about a ray of which the local frame has lost bits.
bool is_rounded(const LocalRay& ray, const EquationBlock& block) {
  return !ray.is_exact && block.wants_coefficient_errors();
}

/// A ray in the plane of a flat profile runs inside the disk if it comes nearer to the axis than the rim.
void settle_in_plane(const BezierProfile& profile, const LocalRay& ray, EquationBlock& block) {
  const double cross = ray.p.x * ray.d.z - ray.p.z * ray.d.x;
  const double rim = profile.cylinder.radius * std::hypot(ray.d.x, ray.d.z);
  if (std::fabs(cross) < rim) block.settle(Status::coincident);
}

}  // namespace

// ------------------------------------------------------------------------------------------------- profile

BezierProfile::BezierProfile(std::vector<double> control_r, std::vector<double> control_y)
    : r(std::move(control_r)), y(std::move(control_y)) {
  constexpr int kLevels = 6;
  cylinder.radius = mag(tight_range(r, kLevels));
  const Interval height = tight_range(y, kLevels);
  cylinder.y_lo = height.lo;
  cylinder.y_hi = height.hi;
  flat = std::all_of(y.begin(), y.end(), [&](double v) { return v == y[0]; });
  if (flat) cylinder.y_lo = cylinder.y_hi = y[0];
  if (!flat) pieces = monotone_pieces(*this);
  orientation = volume_sign(*this);
}

template <class T>
BasicProfilePoint<T> BezierProfile::at(T t) const {
  const Curve<T> cr = evaluate_curve(r, t);
  const Curve<T> cy = evaluate_curve(y, t);
  return {cr.value, flat ? static_cast<T>(y[0]) : cy.value, cr.first, flat ? T{0} : cy.first};
}

template BasicProfilePoint<double> BezierProfile::at(double) const;
template BasicProfilePoint<float> BezierProfile::at(float) const;

template <class T>
T BezierProfile::invert(const MonotonePiece& piece, T height) const {
  T lo = static_cast<T>(piece.t_lo);
  T hi = static_cast<T>(piece.t_hi);
  const T y_lo = static_cast<T>(piece.y_lo), y_hi = static_cast<T>(piece.y_hi);
  const T direction = piece.rising ? T{1} : T{-1};
  const T share = (height - y_lo) / (y_hi - y_lo);
  T t = std::clamp(piece.rising ? lo + share * (hi - lo) : hi - share * (hi - lo), lo, hi);
  constexpr int kSteps = 100;  // bisection alone needs 53 or so from any start
  for (int step = 0; step < kSteps; ++step) {
    const Curve<T> c = evaluate_curve(y, t);
    const T excess = (c.value - height) * direction;
    if (excess == 0) return t;
    (excess > 0 ? hi : lo) = t;
    T next = t - (c.value - height) / c.first;
    if (!(next > lo && next < hi)) next = (lo + hi) / 2;
    if (next == t || next <= lo || next >= hi) break;
    const bool settled = std::fabs(next - t) <= std::numeric_limits<T>::epsilon() * std::fabs(t);
    t = next;
    if (settled) break;
  }
  return t;
}

double BezierProfile::t_of_height(double height, double u) const {
  std::array<const MonotonePiece*, 2 * BezierRevolution::kMaxPoints> reaching;
  std::size_t count = 0;
  for (const MonotonePiece& piece : pieces) {
    if (piece.y_lo <= height && height <= piece.y_hi) reaching[count++] = &piece;
  }
  if (count == 0) return u;  // flat, or beyond the ends: any t is as good
  return invert(*reaching[std::min(count - 1, static_cast<std::size_t>(u * static_cast<double>(count)))],
                height);
}

// ---------------------------------------------------------------------------------------------- polynomial

BezierPolynomial::BezierPolynomial(const BezierRevolution& surface)
    : profile_(surface.profile), regions_{}, grazing_eps_(surface.regions.eps[BezierRegions::kParts]) {
  for (std::size_t i = 0; i < regions_.size(); ++i) {
    regions_[i] = {BezierRegions::kEnds[i], surface.regions.eps[i]};
  }
  const int n = static_cast<int>(profile_.r.size()) - 1;
  const auto choose = [](int a, int b) {
    const double value = binomial(a, b);
    return a <= kMaxExactBinomial ? point(value) : inflate_ulps(point(value), 1);
  };
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) weights_.push_back(choose(n, i) * choose(n, j) / choose(2 * n, i + j));
  }
}

FormulationInfo BezierPolynomial::info() {
  return {"polynomial",
          "q_y^2 R(t)^2 = |q_xz (Y(t) - p_y) + q_y p_xz|^2 in t, Bernstein basis, recentred",
          "document 000's equation for any profile; Bernstein product formula",
          {Form::polynomial}};
}

template <class T>
std::vector<T> BezierPolynomial::coefficients(const LocalRay& ray) const {
  const std::size_t size = profile_.r.size();
  const auto [px, py, pz] = recentred_point<T>(ray);
  const T qx = exactly<T>(ray.d.x), qy = exactly<T>(ray.d.y), qz = exactly<T>(ray.d.z);
  std::array<T, BezierRevolution::kMaxPoints> x, z, r;
  for (std::size_t i = 0; i < size; ++i) {
    const T rise = exactly<T>(profile_.y[i]) - py;
    x[i] = qx * rise + qy * px;
    z[i] = qz * rise + qy * pz;
    r[i] = qy * exactly<T>(profile_.r[i]);
  }
  std::vector<T> c(2 * size - 1, exactly<T>(0));
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t j = 0; j < size; ++j) {
      const T product = r[i] * r[j] - x[i] * x[j] - z[i] * z[j];
      if constexpr (std::is_same_v<T, Interval>) {
        c[i + j] += weights_[i * size + j] * product;
      } else {
        c[i + j] += static_cast<T>(mid(weights_[i * size + j])) * product;
      }
    }
  }
  return c;
}

/// The circles in which the plane of a horizontal ray meets the monotone pieces, as quadratics in delta.
void BezierPolynomial::pose_circles(const LocalRay& ray, EquationBlock& block) const {
  for (std::size_t i = 0; i < profile_.pieces.size(); ++i) {
    const MonotonePiece& piece = profile_.pieces[i];
    if (ray.o.y < piece.y_lo || ray.o.y > piece.y_hi) continue;
    pose_polynomial(block, kCircle + static_cast<std::uint32_t>(i), Basis::power, ray.lo, ray.hi, {},
                    [&](auto number) {
                      using T = decltype(number);
                      T radius;
                      if constexpr (std::is_same_v<T, Interval>) {
                        const Interval t = PieceAlongRay(profile_, piece, ray).parameter(point(ray.o.y));
                        radius = bernstein_evaluate(profile_.r, {}, t);
                      } else {
                        radius = profile_.at(profile_.invert(piece, exactly<T>(ray.o.y))).r;
                      }
                      const auto [px, py, pz] = recentred_point<T>(ray);
                      const T dx = exactly<T>(ray.d.x), dz = exactly<T>(ray.d.z);
                      return revolution::circle_coefficients<T>(px, pz, dx, dz, radius);
                    });
  }
}

void BezierPolynomial::pose(const LocalRay& ray, EquationBlock& block) const {
  if (!revolution::is_usable(ray)) return block.settle(Status::failed);
  if (is_rounded(ray, block)) return block.settle(Status::uncertain);
  const Epsilons epsilons{regions_, grazing_eps_, 0};
  const std::size_t size = profile_.r.size();
  if (ray.d.y == 0) {
    if (profile_.flat) return settle_in_plane(profile_, ray, block);
    return pose_circles(ray, block);
  }
  if (ray.d.x == 0 && ray.d.z == 0) {
    // |R(t)| = u unsquared: R - u, and R + u where the profile crosses the axis.
    const bool crosses = *std::min_element(profile_.r.begin(), profile_.r.end()) < 0;
    for (const double side : {1.0, -1.0}) {
      if (side < 0 && (!crosses || (ray.o.x == 0 && ray.o.z == 0))) continue;
      pose_polynomial(block, kAxis, Basis::bernstein, 0, 1, epsilons, [&](auto number) {
        using T = decltype(number);
        using std::sqrt;
        const T u = exactly<T>(side) * sqrt(sqr(exactly<T>(ray.o.x)) + sqr(exactly<T>(ray.o.z)));
        std::vector<T> c;
        for (std::size_t i = 0; i < size; ++i) c.push_back(exactly<T>(profile_.r[i]) - u);
        return c;
      });
    }
    return;
  }
  pose_polynomial(block, kSurface, Basis::bernstein, 0, 1, epsilons,
                  [&](auto number) { return coefficients<decltype(number)>(ray); });
}

void BezierPolynomial::lift(const LocalRay& ray, const Posed& posed, const Root& root,
                            std::vector<LocalHit>& hits) const {
  if (posed.kind >= kCircle) {
    const double t = profile_.invert(profile_.pieces[posed.kind - kCircle], ray.o.y);
    hits.push_back({.multiplicity = root.multiplicity, .delta = root.x, .t = t});
    return;
  }
  const ProfilePoint c = profile_.at(root.x);
  const bool at_pole = (root.x == 0 || root.x == 1) && c.r == 0;
  // The squared equation has a double root at a pole that the ray passes through once.
  hits.push_back(revolution::hit_at_height(c.y, ray.p.y, ray.d.y, root.x));
  hits.back().multiplicity = at_pole && posed.kind == kSurface ? 1 : root.multiplicity;
}

double BezierPolynomial::place(const LocalRay& ray, double delta) const {
  const Vec3 x = ray.at(delta);
  const double radius = std::hypot(x.x, x.z);
  double nearest = std::numeric_limits<double>::infinity();
  double t = 0;
  for (const MonotonePiece& piece : profile_.pieces) {
    const double height = std::clamp(x.y, piece.y_lo, piece.y_hi);
    const double candidate = profile_.invert(piece, height);
    const double distance = std::hypot(x.y - height, radius - std::fabs(profile_.at(candidate).r));
    if (distance < nearest) {
      nearest = distance;
      t = candidate;
    }
  }
  // Where Y turns its height hardly says t: the foot of the point on the curve, by Gauss and Newton, does.
  for (int step = 0; step < 2; ++step) {
    const ProfilePoint c = profile_.at(t);
    const double dr = std::copysign(1.0, c.r) * c.dr;
    const double move = (radius - std::fabs(c.r)) * dr + (x.y - c.y) * c.dy;
    const double size = dr * dr + c.dy * c.dy;
    if (size > 0) t = std::clamp(t + move / size, 0.0, 1.0);
  }
  return t;
}

// ----------------------------------------------------------------------------------------------- along_ray

BezierAlongRay::BezierAlongRay(const BezierRevolution& surface)
    : profile(surface.profile), regions(surface.regions) {}

FormulationInfo BezierAlongRay::info() {
  return {"along_ray",
          "F(l) = R(t(y))^2 - |x_xz|^2 in l on each monotone piece of Y, recentred",
          "graze (surfaces/bezier_revolution.md)",
          {Form::scalar, Form::interval}};
}

void BezierAlongRay::pose(const LocalRay& ray, EquationBlock& block) const {
  if (!revolution::is_usable(ray)) return block.settle(Status::failed);
  if (is_rounded(ray, block)) return block.settle(Status::uncertain);
  if (profile.flat) {
    // A plane figure has no F along the ray: y is one value only. In its plane the ray runs inside it.
    if (ray.d.y == 0) return settle_in_plane(profile, ray, block);
    return block.settle(Status::failed);
  }
  const double unit = std::max(profile.cylinder.radius, profile.cylinder.y_hi - profile.cylinder.y_lo);
  for (std::size_t i = 0; i < profile.pieces.size(); ++i) {
    double lo = 0, hi = 0;
    if (!piece_range(profile.pieces[i], ray, lo, hi)) continue;
    PieceAlongRay* const self = block.arena().make(PieceAlongRay(profile, profile.pieces[i], ray));
    const auto kind = static_cast<std::uint32_t>(i);
    if (block.form() == Form::scalar) {
      pose_scalar(block, kind, self, lo, hi, 0, hash_combine(ray.seed(), i));
    } else {
      self->prepare_intervals();
      pose_interval(block, kind, self, lo, hi,
                    epsilons_along(regions, profile, profile.pieces[i], ray, unit, block.arena()));
    }
  }
}

void BezierAlongRay::lift(const LocalRay& ray, const Posed& posed, const Root& root,
                          std::vector<LocalHit>& hits) const {
  const MonotonePiece& piece = profile.pieces[posed.kind];
  const double y = std::clamp(std::fma(root.x, ray.d.y, ray.p.y), piece.y_lo, piece.y_hi);
  const double t = profile.invert(piece, y);
  if (posed.kind > 0 && t == piece.t_lo) return;  // the ring between two pieces belongs to the one before
  hits.push_back({.multiplicity = root.multiplicity, .delta = root.x, .t = t, .is_root = true});
}

// -------------------------------------------------------------------------------------------------- system

BezierSystem::BezierSystem(const BezierRevolution& surface) : profile(surface.profile) {}

FormulationInfo BezierSystem::info() {
  return {"system",
          "o + l d = S(t, theta): three equations in (l, t, theta), recentred",
          "document 003 with the sign of its Jacobian corrected",
          {Form::system}};
}

void BezierSystem::lift(const LocalRay& /*ray*/, const Posed& /*posed*/, const Root& root,
                        std::vector<LocalHit>& hits) const {
  hits.push_back({.multiplicity = root.multiplicity, .delta = root.x, .t = root.others[0]});
}

// ------------------------------------------------------------------------------------------------- surface

SurfaceInfo BezierRevolution::info() {
  SurfaceInfo info;
  info.summary = "planar Bezier profile of any degree revolved about y";
  info.source = "document 003";
  info.page = "surfaces/bezier_revolution.md";
  info.parameters = {"control_points"};
  info.params = {"t", "theta"};
  info.regions = {BezierRegions::kNames.begin(), BezierRegions::kNames.end()};
  return info;
}

Parameters BezierRevolution::scaled(const Parameters& parameters, double factor) {
  constexpr std::array kLengths{Length{"control_points"}};
  return scale_lengths(parameters, kLengths, factor);
}

BezierRevolution::BezierRevolution(const SurfaceSpec& spec) {
  const auto points = spec.parameters.table("control_points", 2);
  if (points.size() < 2) throw std::invalid_argument("control_points: a curve needs at least 2 points");
  if (points.size() > kMaxPoints) {
    throw std::invalid_argument("control_points: at most " + std::to_string(kMaxPoints) + " points (degree " +
                                std::to_string(kMaxPoints - 1) + ")");
  }
  double largest_r = 0, lowest = points[0][1], highest = points[0][1];
  for (const auto& p : points) {
    largest_r = std::max(largest_r, std::fabs(p[0]));
    lowest = std::min(lowest, p[1]);
    highest = std::max(highest, p[1]);
  }
  const bool all_equal =
      std::all_of(points.begin(), points.end(), [&](const auto& p) { return p == points[0]; });
  if (all_equal) throw std::invalid_argument("control_points: all points are equal, which is no surface");
  if (largest_r == 0)
    throw std::invalid_argument("control_points: all points lie on the axis, which is no surface");

  size_ = std::max(largest_r, highest - lowest);
  if (!std::isfinite(size_))
    throw std::invalid_argument("control_points: the heights span more than a double holds");
  unit_ = exponent_of(size_);
  std::vector<double> r, y;
  for (const auto& p : points) {
    r.push_back(scale_by_power(p[0], -unit_));
    y.push_back(scale_by_power(p[1], -unit_));
    control_points.push_back({p[0], p[1]});
  }
  profile = BezierProfile(std::move(r), std::move(y));
  regions.eps = {0x1p-40, 0x1p-44, 0x1p-40, 0x1p-24};
  override_eps(spec, BezierRegions::kNames, regions.eps);
}

bool BezierRevolution::is_exact_in_unit() const {
  constexpr int kMostUnit = 1022;
  if (std::abs(unit_) >= kMostUnit) return false;
  for (std::size_t i = 0; i < control_points.size(); ++i) {
    const auto [r, y] = control_points[i];
    if (scale_by_power(profile.r[i], unit_) != r || scale_by_power(profile.y[i], unit_) != y) return false;
  }
  return true;
}

LocalPoint BezierRevolution::describe(const LocalRay& ray, const LocalHit& hit) const {
  const double pole_direction = profile.orientation * (hit.t < 0.5 ? -1.0 : 1.0);
  return revolution::describe(ray, hit, profile.at(hit.t), profile.orientation, pole_direction);
}

}  // namespace graze
