#include <graze/surfaces/teardrop_double_double.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace graze {
namespace {

constexpr double kU2 = 0x1p-106;    // u^2
constexpr double kTiny = 0x1p-800;  // above what underflow can add to a bound, far below what matters

using Proved = LineAnswer::Proved;
using Origin = LineAnswer::Origin;

/// F = R^2 - |x_xz|^2 at a point of the line, with a bound on its error.
struct Value {
  DoubleDouble f;
  double error = 0;
  bool is_beside = false;  ///< certainly below the bottom or above the apex

  [[nodiscard]] bool is_inside() const { return !is_beside && f.hi > error; }
  [[nodiscard]] bool is_outside() const { return is_beside || f.hi < -error; }
};

/// F and its slope along the line, in double: they only guide steps.
struct Slopes {
  double f = 0, df = 0;
};

class Line {
 public:
  Line(const Ray& ray, double m)
      : o_(ray.o), d_(ray.d), m_(m), six_m_(two_prod(6, m)), nine_m2_(9 * two_prod(m, m)) {
    // Any double near the closest approach to the widest circle's centre will do.
    const double dd = dot(d_, d_);
    centre_ = (d_.x * -ray.o.x + d_.y * (2.52 * m - ray.o.y) + d_.z * -ray.o.z) / dd;
    const auto moved = [&](double o, double d) { return two_prod(centre_, d) + o; };
    p_ = {moved(ray.o.x, d_.x), moved(ray.o.y, d_.y), moved(ray.o.z, d_.z)};
    const auto in_range = [](double x) { return std::fabs(x) < 0x1p400; };
    usable_ = in_range(centre_) && in_range(ray.o.x) && in_range(ray.o.y) && in_range(ray.o.z);
  }

  [[nodiscard]] bool is_usable() const { return usable_; }
  [[nodiscard]] double centre() const { return centre_; }

  /// Error terms: p within 2 u^2 of each coordinate, delta d within 2, their sum within 3
  /// (double_double.hpp); v, 1 - v, sqrt and the quotient within 16, 19, 4 and 15, so that rho = 9 m^2 v g^2
  /// is within 160 of itself plus |d rho / dy| times the error of y.
  [[nodiscard]] Value value(const DoubleDouble& delta) const {
    const DoubleDouble x = p_[0] + delta * d_.x, y = p_[1] + delta * d_.y, z = p_[2] + delta * d_.z;
    return value_at({x, y, z}, {error_of(p_[0], delta, d_.x, x), error_of(p_[1], delta, d_.y, y),
                                error_of(p_[2], delta, d_.z, z)});
  }
  /// At l = 0: no error of the point itself.
  [[nodiscard]] Value value_at_origin() const { return value_at({o_.x, o_.y, o_.z}, {}); }

  /// `e`: of x, y, z.
  [[nodiscard]] Value value_at(const std::array<DoubleDouble, 3>& point, Vec3 e) const {
    const auto& [x, y, z] = point;
    const auto [ex, ey, ez] = e;
    const DoubleDouble below = six_m_ - y;
    Value result;
    result.is_beside = y.hi < -ey || below.hi < -2 * ey - 4 * kU2 * six_m_.hi;
    const DoubleDouble v = std::max(y, DoubleDouble(0)) / six_m_;
    const DoubleDouble t = sqrt(v);
    const DoubleDouble g = below / six_m_ * (t + 2) / (t + 1);
    const DoubleDouble rho = nine_m2_ * v * sqr(g);
    const DoubleDouble square = sqr(x) + sqr(z);
    result.f = rho - square;
    const double e_height = ey + 4 * kU2 * six_m_.hi;
    // |d rho / dy| = 3/2 m g |2 - 3v - 2t| here, at most 6 m anywhere; it turns by less than 32 an unit of y
    // where v > 2^-10.
    const double turn = std::fabs(2 - 3 * v.hi - 2 * t.hi);
    const double local = 1.5 * m_ * std::fabs(g.hi) * turn + 32 * e_height;
    const double slope = v.hi > 0x1p-10 ? std::min(local, 6 * m_) : 6 * m_;
    result.error =
        1.01 * (160 * kU2 * rho.hi + slope * e_height + 2 * (std::fabs(x.hi) * ex + std::fabs(z.hi) * ez) +
                ex * ex + ez * ez + 16 * kU2 * square.hi) +
        kTiny;
    return result;
  }

  [[nodiscard]] Slopes slopes(double delta) const {
    const double x = p_[0].hi + delta * d_.x, y = p_[1].hi + delta * d_.y, z = p_[2].hi + delta * d_.z;
    const double v = std::max(y / six_m_.hi, 0x1p-80), t = std::sqrt(v), k = d_.y / six_m_.hi;
    const double g = 2 - v - t, turn = 2 - 3 * v - 2 * t;
    return {nine_m2_.hi * v * g * g - x * x - z * z, nine_m2_.hi * g * turn * k - 2 * (x * d_.x + z * d_.z)};
  }

  /// How far the point is inside the body's circle at its height: G = R - |x_xz|, concave along the line,
  /// with its first two derivatives; not a number outside of the slab 0 <= y <= 6m.
  struct Depth {
    double g = 0, dg = 0, ddg = 0;
  };
  [[nodiscard]] Depth depth(double delta) const {
    const double x = p_[0].hi + delta * d_.x, y = p_[1].hi + delta * d_.y, z = p_[2].hi + delta * d_.z;
    const double t = std::sqrt(y / six_m_.hi), rho = std::hypot(x, z);
    const double rise = (2 - t * (2 + 3 * t)) / (4 * t) * d_.y;
    const double spread = rho > 0 ? (x * d_.x + z * d_.z) / rho : 0;
    const double flat = d_.x * d_.x + d_.z * d_.z;
    return {3 * m_ * t * (1 - t) * (2 + t) - rho, rise - spread,
            -(2 + 3 * t * t) / (48 * m_ * t * t * t) * d_.y * d_.y -
                (rho > 0 ? std::max(0.0, flat - spread * spread) / rho : 0)};
  }

  /// What falls through zero at a crossing, with its slope: G, or F in the lower half of the body.
  struct Descent {
    double value = 0, slope = 0;
    bool on_depth = false;
  };
  [[nodiscard]] Descent descent(double delta) const {
    const double y = p_[1].hi + delta * d_.y;
    if (y > 0.5 * six_m_.hi) {
      const Depth here = depth(delta);
      return {here.g, here.dg, true};
    }
    const Slopes here = slopes(delta);
    return {here.f, here.df, false};
  }

  /// G' to twice the digits where 0 < y < 6m and the point is off the axis, and a bound on its error: fewer
  /// than 32 operations within 16 u^2 on terms of the sizes given, and y's and rho's errors over t^3 and rho.
  struct Slope {
    DoubleDouble value;
    double error = 0;
  };
  [[nodiscard]] Slope depth_slope(const DoubleDouble& delta) const {
    const DoubleDouble x = p_[0] + delta * d_.x, y = p_[1] + delta * d_.y, z = p_[2] + delta * d_.z;
    const DoubleDouble t = sqrt(y / six_m_), rho = sqrt(sqr(x) + sqr(z));
    const DoubleDouble rise = (2 - t * (2 + 3 * t)) / (4 * t) * d_.y;
    const DoubleDouble spread = (x * d_.x + z * d_.z) / rho;
    const double size = 2 * std::fabs(d_.y) / t.hi + 4;
    const double moved = coordinate_error(delta);
    const double bend = d_.y * d_.y / (t.hi * t.hi * t.hi) + 8 / rho.hi;
    return {rise - spread, 1024 * kU2 * size + moved * bend};
  }

  /// The part of the line between the planes of the poles, as rounded.
  [[nodiscard]] std::array<double, 2> slab() const {
    constexpr double kFar = 0x1p20;  // a line that flat leaves every body's reach before
    const double a = -p_[1].hi / d_.y, b = (six_m_.hi - p_[1].hi) / d_.y;
    if (d_.y == 0 || !(std::fabs(a) < kFar && std::fabs(b) < kFar)) return {-kFar, kFar};
    return {std::min(a, b), std::max(a, b)};
  }
  /// Of p from the axis and the bottom, a coordinate.
  [[nodiscard]] double reach() const {
    return std::max({std::fabs(p_[0].hi), std::fabs(p_[1].hi), std::fabs(p_[2].hi)});
  }
  [[nodiscard]] double distance_from_axis(const DoubleDouble& delta) const {
    return std::hypot(p_[0].hi + delta.hi * d_.x, p_[2].hi + delta.hi * d_.z);
  }
  [[nodiscard]] double distance_from_origin(const DoubleDouble& delta) const {
    return std::hypot(p_[0].hi + delta.hi * d_.x, p_[1].hi + delta.hi * d_.y, p_[2].hi + delta.hi * d_.z);
  }
  /// Where a line that is not level passes the apex's plane, and how |x_xz|^2 - (9/16) d_y^2 e^2 =
  /// w + 2 b e + a e^2 goes on into the slab. `error`: of x and z there.
  struct Top {
    DoubleDouble delta;
    bool runs_up = false;
    Vec3 xz;
    double error = 0;
    DoubleDouble w, b, a;
  };
  [[nodiscard]] Top at_top() const {
    const DoubleDouble delta = (six_m_ - p_[1]) / d_.y;
    const DoubleDouble x = p_[0] + delta * d_.x, z = p_[2] + delta * d_.z;
    const DoubleDouble flat = two_prod(d_.x, d_.x) + two_prod(d_.z, d_.z);
    const DoubleDouble outward = x * d_.x + z * d_.z;
    return {delta,
            d_.y > 0,
            {x.hi, 0, z.hi},
            coordinate_error(delta),
            sqr(x) + sqr(z),
            d_.y > 0 ? -outward : outward,
            flat - 0.5625 * two_prod(d_.y, d_.y)};
  }
  [[nodiscard]] double rise() const { return d_.y; }
  [[nodiscard]] bool is_level() const { return d_.y == 0; }

 private:
  /// Of a coordinate at delta, with room for an error of 16 u^2 |delta| of delta itself.
  [[nodiscard]] double coordinate_error(const DoubleDouble& delta) const {
    return 64 * kU2 * (std::fabs(delta.hi) * 2 + reach() + 16);
  }
  static double error_of(const DoubleDouble& p, const DoubleDouble& delta, double d,
                         const DoubleDouble& sum) {
    return kU2 * (3 * std::fabs(p.hi) + 3 * std::fabs(delta.hi * d) + 4 * std::fabs(sum.hi));
  }

  Vec3 o_, d_;
  double m_;
  DoubleDouble six_m_, nine_m2_;
  double centre_ = 0;
  std::array<DoubleDouble, 3> p_;
  bool usable_ = false;
};

/// Near the point of the line where it is deepest in the body, or least far from it: G' falls along the line,
/// so its zero is bracketed by signs; Newton's steps where they stay inside the bracket, else halving.
DoubleDouble deepest(const Line& line) {
  constexpr int kSteps = 60, kSharp = 2;
  auto [lo, hi] = line.slab();
  double delta = lo <= 0 && hi >= 0 ? 0 : 0.5 * (lo + hi);
  for (int i = 0; i < kSteps; ++i) {
    const Line::Depth here = line.depth(delta);
    if (here.dg == 0) break;
    (here.dg > 0 ? lo : hi) = delta;
    double next = delta - here.dg / here.ddg;
    if (!(next > lo && next < hi)) next = 0.5 * (lo + hi);
    const double step = std::fabs(next - delta);
    delta = next;
    if (step <= 0x1p-50 * (std::fabs(delta) + 1)) break;
  }
  DoubleDouble sharp = delta;
  for (int i = 0; i < kSharp; ++i) {
    const double bend = line.depth(sharp.hi).ddg;
    const DoubleDouble next = sharp - line.depth_slope(sharp).value / bend;
    // On the axis or at a pole's plane there is no such step.
    if (!(std::fabs(next.hi - sharp.hi) <= 0x1p-30 * (std::fabs(sharp.hi) + 1))) break;
    sharp = next;
  }
  return sharp;
}

/// G is concave: it lies below its tangent. So the line misses where G at one point is further below zero
/// than the tangent's slope can make up for on the way to the body: no point of that is further from the
/// origin of the frame than 8 m, and |d| >= 1.
bool misses(const Line& line, const DoubleDouble& at, const Value& value, double m) {
  if (!value.is_outside() || value.is_beside) return false;
  const Line::Slope slope = line.depth_slope(at);
  // F = G (R + rho), and R + rho = 2 rho + G <= 2 rho.
  const double below = (-value.f.hi - value.error) / (2.01 * line.distance_from_axis(at));
  const double way = line.distance_from_origin(at) + 8 * m;
  return below > 1.01 * (std::fabs(slope.value.hi) + slope.error) * way;
}

/// The line beside the apex, in the distance e from the apex's plane into the slab: with h = |d_y| e the
/// body's R^2 is between (9/16) h^2 (1 - h/4m) and (9/16) h^2 for h < m, so where q(e) = |x_xz|^2 - (9/16)
/// d_y^2 e^2 = w + 2 b e + a e^2 is positive the line is outside, and where it is below -(9/64) |d_y e|^3 / m
/// inside.
class Tip {
 public:
  Tip(const Line& line, double m)
      : top_(line.at_top()), cubic_(0.15 * std::pow(std::fabs(line.rise()), 3) / m) {
    // Products of numbers within top_.error, and at most 16 roundings in double-double.
    const double size = norm(top_.xz) + top_.error;
    e_w_ = 4 * size * top_.error + 16 * kU2 * size * size;
    e_b_ = 8 * top_.error + 64 * kU2 * size;
    is_flatter_ = !line.is_level() && top_.a.hi > 0x1p-60 && top_.w.hi > 4 * e_w_;
  }

  /// Lines that are flatter than the cone and have no e > 0 with q(e) <= 0.
  [[nodiscard]] bool is_missed() const {
    if (!is_flatter_) return false;
    return top_.b.hi > e_b_ || discriminant().hi < -discriminant_error();
  }
  /// Where q vanishes, if the signs around prove that the surface is crossed there; ascending.
  [[nodiscard]] std::optional<std::array<double, 2>> crossings(double m) const {
    if (!is_flatter_ || !(top_.b.hi < -e_b_) || !(discriminant().hi > discriminant_error()))
      return std::nullopt;
    const double far = (-top_.b.hi + std::sqrt(discriminant().hi)) / top_.a.hi;
    const double near = top_.w.hi / top_.a.hi / far;
    const double aside = (far - near) / 64;
    const bool is_proved = near > aside && far < 0x1p-20 * m && is_outside(near - aside) &&
                           is_inside(near + aside) && is_inside(far - aside) && is_outside(far + aside);
    if (!is_proved) return std::nullopt;
    return std::array{near, far};
  }
  /// delta at e.
  [[nodiscard]] DoubleDouble delta(double e) const { return top_.delta + (top_.runs_up ? -e : e); }

 private:
  [[nodiscard]] DoubleDouble discriminant() const { return sqr(top_.b) - top_.a * top_.w; }
  [[nodiscard]] double discriminant_error() const {
    // a is within 16 u^2 of a sum of sizes below 8.
    return 2 * e_b_ * (std::fabs(top_.b.hi) + e_b_) + 8 * e_w_ + 256 * kU2 * (top_.w.hi + sqr(top_.b.hi));
  }
  [[nodiscard]] DoubleDouble q(double e) const { return top_.w + (top_.b * 2 + top_.a * e) * e; }
  [[nodiscard]] double q_error(double e) const {
    return e_w_ + 2 * e_b_ * e + 256 * kU2 * (top_.w.hi + 2 * std::fabs(top_.b.hi) * e + 8 * e * e);
  }
  [[nodiscard]] bool is_outside(double e) const { return q(e).hi > q_error(e); }
  [[nodiscard]] bool is_inside(double e) const { return q(e).hi < -q_error(e) - cubic_ * e * e * e; }
  static double sqr(double x) { return x * x; }
  static DoubleDouble sqr(const DoubleDouble& x) { return graze::sqr(x); }

  Line::Top top_;
  double cubic_, e_w_ = 0, e_b_ = 0;
  bool is_flatter_ = false;
};

/// The crossing in direction `sense` of an inside point, in double. Newton's steps on G, which is concave:
/// from outside they never pass the root. On F in the lower half, where G rises like a root from the bottom.
double approach(const Line& line, double inside, double sense) {
  constexpr int kSteps = 40;
  constexpr double kShallow = 0x1p-30;
  auto [lo, hi] = line.slab();
  double in = inside, out = sense > 0 ? hi : lo;
  // F = 2 rho G + G^2. Near the deepest point G is a parabola; where it is shallow, to all of a double's
  // digits.
  const double size = 2 * line.distance_from_axis(inside);
  const double g = line.value(inside).f.hi / size;
  double delta = inside + sense * std::sqrt(2 * std::max(g, 0.0) / -line.depth(inside).ddg);
  if (g < kShallow * size) return delta;
  for (int i = 0; i < kSteps; ++i) {
    if (!(sense * delta > sense * in && sense * delta < sense * out)) delta = 0.5 * (in + out);
    const Line::Descent here = line.descent(delta);
    (here.value > 0 ? in : out) = delta;
    const double next = delta - here.value / here.slope;
    const double step = std::fabs(next - delta);
    delta = next;
    if (step <= 0x1p-51 * std::fabs(delta) || delta == in || delta == out) break;
  }
  return std::clamp(delta, std::min(in, out), std::max(in, out));
}

/// The crossing between an inside point and the outside in direction `sense`, its sides proved.
std::optional<LineCrossing> crossing(const Line& line, const DoubleDouble& inside, double sense) {
  constexpr int kWiden = 30, kRefine = 80;
  DoubleDouble in = inside, out;
  Value at_out;
  double near = approach(line, inside.hi, sense);
  // At the apex's plane and beyond G is no number.
  if (!std::isfinite(near)) near = line.slab()[sense > 0 ? 1 : 0];
  const double size = std::fabs(near) + std::fabs(line.centre()) + 1;
  // Widened until both sides are proved; only the outer one must be.
  bool is_passed = false;
  double width = 0x1p-50 * size;
  for (int i = 0; i < kWiden && !is_passed; ++i, width *= 16) {
    out = near + sense * width;
    at_out = line.value(out);
    is_passed = at_out.is_outside();
    const DoubleDouble closer = near - sense * width;
    const bool between = sense > 0 ? closer > in : closer < in;
    if (between && line.value(closer).is_inside()) in = closer;
  }
  if (!is_passed) return std::nullopt;
  // Newton's step from the outer end with the sharp value there; every third step halves, so that a slope
  // that misleads costs no more than a factor. Every end keeps its proved side.
  for (int i = 0; i < kRefine; ++i) {
    const DoubleDouble gap = out - in;
    if (std::fabs(gap.hi) <= 0x1p-58 * (std::fabs(in.hi) + std::fabs(line.centre()))) break;
    const Line::Descent s = line.descent(out.hi);
    const double value =
        s.on_depth ? at_out.f.hi / (2 * line.distance_from_axis(out) + s.value) : at_out.f.hi;
    double step = value / (sense * s.slope);
    const bool is_newton = i % 3 != 2 && step > 0 && step < std::fabs(gap.hi);
    if (!is_newton) step = 0.5 * std::fabs(gap.hi);
    const double noise =
        is_newton ? std::max(2 * std::fabs(at_out.error / at_out.f.hi) * step, 0x1p-60 * size) : 0;
    const DoubleDouble root = out - sense * step;
    bool is_open = false;
    for (const double shift : {noise, -noise}) {
      const DoubleDouble probe = root + sense * shift;
      const bool between = sense > 0 ? probe > in && probe < out : probe < in && probe > out;
      if (!between) continue;
      const Value there = line.value(probe);
      if (there.is_inside()) {
        in = probe;
      } else if (there.is_outside()) {
        out = probe;
        at_out = there;
      } else {
        is_open = true;
      }
      if (!is_newton) break;
    }
    // Where the sign is lost in rounding the surface is as near as can be told.
    if (is_open) return LineCrossing{root, std::min(in, out), std::max(in, out)};
  }
  return LineCrossing{in + 0.5 * (out - in), std::min(in, out), std::max(in, out)};
}

}  // namespace

LineAnswer prove_line(const Ray& local, double m, bool first_only) {
  const Line line(local, m);
  LineAnswer answer;
  answer.centre = line.centre();
  if (!line.is_usable()) return answer;
  const Value at_origin = line.value_at_origin();
  answer.origin = at_origin.is_inside()    ? Origin::inside
                  : at_origin.is_outside() ? Origin::outside
                                           : Origin::on;
  const DoubleDouble top = deepest(line);
  const Value value = line.value(top);
  if (value.is_inside()) {
    const auto entry = crossing(line, top, -1);
    if (!entry) return answer;
    const bool is_ahead = (entry->lo + line.centre()).hi > 0;
    const auto exit = first_only && is_ahead ? entry : crossing(line, top, 1);
    if (!exit) return answer;
    answer.proved = Proved::crosses;
    answer.entry = *entry;
    answer.exit = *exit;
    return answer;
  }
  const Tip tip(line, m);
  if (misses(line, top, value, m) || tip.is_missed()) {
    answer.proved = Proved::misses;
  } else if (const auto e = tip.crossings(m)) {
    const double aside = ((*e)[1] - (*e)[0]) / 64;
    const auto at = [&](double x) {
      const DoubleDouble a = tip.delta(x - aside), b = tip.delta(x + aside);
      return LineCrossing{tip.delta(x), std::min(a, b), std::max(a, b)};
    };
    answer.proved = Proved::crosses;
    answer.entry = at((*e)[line.rise() > 0 ? 1 : 0]);
    answer.exit = at((*e)[line.rise() > 0 ? 0 : 1]);
  }
  return answer;
}

}  // namespace graze
