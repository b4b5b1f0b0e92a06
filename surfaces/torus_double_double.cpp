#include <graze/surfaces/torus_double_double.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace graze {
namespace {

constexpr double kU2 = 0x1p-106;    // u^2
constexpr double kPay = 1.01;       // pays for the roundings of a bound itself
constexpr double kTiny = 0x1p-800;  // above what underflow can add to a bound, far below what matters

/// f and f' with bounds on their errors, f'' to a double's digits.
struct Value {
  DoubleDouble f, df;
  double ddf = 0;
  double error = 0, slope_error = 0;

  [[nodiscard]] bool is_outside(double slack = 0) const { return f.hi > kPay * (error + slack); }
  [[nodiscard]] bool is_inside() const { return f.hi < -kPay * error; }
};

/// f = K^2 + weight (y^2 - r^2), K = |x|^2 - R^2 - r^2, along a line about its foot.
class Line {
 public:
  Line(const Ray& ray, double ring, double tube)
      : tube_(tube), weight_(4 * two_prod(ring, ring)), dy_(ray.d.y) {
    const double o[] = {ray.o.x, ray.o.y, ray.o.z}, d[] = {ray.d.x, ray.d.y, ray.d.z};
    const double dd = dot(ray.d, ray.d);
    const double far = -dot(ray.o, ray.d) / dd;
    DoubleDouble p[3];
    for (int i = 0; i < 3; ++i) p[i] = two_prod(far, d[i]) + o[i];
    // The second step takes what the rounding of the first left, to twice the digits.
    const double near = -(p[0] * d[0] + p[1] * d[1] + p[2] * d[2]).hi / dd;
    centre_ = two_sum(far, near);
    double size_p = 0;
    for (int i = 0; i < 3; ++i) {
      const double before = std::fabs(p[i].hi);
      p[i] += two_prod(near, d[i]);
      const double size = before + std::fabs(p[i].hi);
      a_ += two_prod(d[i], d[i]);
      b_ += p[i] * d[i];
      k_ += sqr(p[i]);
      size_b_ += size * std::fabs(d[i]);
      size_p += size * size;
      if (i == 1) size_y_ = size;
    }
    const DoubleDouble sum = two_prod(ring, ring) + two_prod(tube, tube);
    k_ -= sum;
    py_ = p[1];
    error_k_ = kPay * kU2 * (20 * size_p + 4 * sum.hi + 4 * std::fabs(k_.hi)) + kTiny;
    slant_ = kPay * (std::fabs(b_.hi) + 12 * kU2 * size_b_);
    // Outside of |delta| <= extent K exceeds 2 R r; a thousandth more than that does no harm.
    constexpr double kMore = 0x1p-10;
    extent_ = std::sqrt((std::max(2 * ring * tube - k_.hi, 0.0) + kMore) / a_.hi) + 2 * slant_;
    find_region();
    const auto in_range = [](double x) { return std::fabs(x) < 0x1p400; };
    usable_ = in_range(far) && in_range(o[0]) && in_range(o[1]) && in_range(o[2]) && error_k_ < 1;
  }

  [[nodiscard]] bool is_usable() const { return usable_; }
  [[nodiscard]] DoubleDouble centre() const { return centre_; }
  [[nodiscard]] double extent() const { return extent_; }
  /// f'' >= 0 for |delta| >= edge; between, f'' <= bend. slack = bend edge^2 / 2.
  [[nodiscard]] DoubleDouble edge() const { return edge_; }
  [[nodiscard]] double bend() const { return bend_; }
  [[nodiscard]] double slack() const { return slack_; }

  /// Error terms in the order of the operations, in units of u^2: surfaces/torus.md.
  [[nodiscard]] Value value(const DoubleDouble& delta) const {
    const DoubleDouble reach = a_ * delta, eta = reach + b_;
    const DoubleDouble k = (reach + scaled(b_, 2)) * delta + k_;
    const DoubleDouble y = py_ + delta * dy_;
    const DoubleDouble drop = weight_ * ((y - tube_) * (y + tube_));
    const DoubleDouble swing = scaled(eta * k, 4), tilt = scaled(weight_ * (y * dy_), 2);
    const double way = std::fabs(delta.hi), size_k = std::fabs(k.hi), size_y = std::fabs(y.hi);
    const double error_k = error_k_ + kU2 * (21 * a_.hi * way * way + 40 * size_b_ * way + 4 * size_k);
    const double error_y = kU2 * (2 * way * std::fabs(dy_) + 3 * size_y + 3 * size_y_);
    const double error_eta = kU2 * (15 * a_.hi * way + 4 * std::fabs(eta.hi) + 12 * size_b_);
    Value result;
    result.f = sqr(k) + drop;
    result.df = swing + tilt;
    result.ddf = 8 * eta.hi * eta.hi + 4 * a_.hi * k.hi + 2 * weight_.hi * dy_ * dy_;
    result.error = kPay * ((2 * size_k + error_k) * error_k + weight_.hi * (2 * size_y + error_y) * error_y +
                           kU2 * (18 * std::fabs(drop.hi) + 9 * size_k * size_k)) +
                   kTiny;
    result.slope_error = kPay * (4 * std::fabs(eta.hi) * error_k + 4 * error_eta * (size_k + error_k) +
                                 2 * weight_.hi * std::fabs(dy_) * error_y +
                                 kU2 * (12 * std::fabs(swing.hi) + 18 * std::fabs(tilt.hi))) +
                         kTiny;
    return result;
  }

  /// Whether f'' >= ddf / 2 for certain.
  [[nodiscard]] bool is_bent(const Value& at, const DoubleDouble& delta) const {
    const double eta = a_.hi * delta.hi;
    const double size = 12 * eta * eta + 4 * a_.hi * std::fabs(k_.hi) + 2 * weight_.hi * dy_ * dy_;
    return at.ddf > 0x1p-46 * size;
  }
  /// f' = 4 a^2 (delta^3 - 3 i delta + j) about the foot, in double.
  [[nodiscard]] double cubic_i() const { return turn_.hi / (a_.hi * a_.hi); }
  [[nodiscard]] double cubic_j() const { return 0.5 * weight_.hi * py_.hi * dy_ / (a_.hi * a_.hi); }
  [[nodiscard]] double lead() const { return a_.hi * a_.hi; }

 private:
  /// f'' = 12 ((a delta + b)^2 - turn).
  void find_region() {
    const DoubleDouble lift = weight_ * (DoubleDouble(dy_) * dy_);
    const DoubleDouble ak = a_ * k_;
    turn_ = (scaled(ak - sqr(b_), 2) + lift) / -6.0;
    const double error = kPay * (a_.hi * error_k_ + kU2 * (40 * (std::fabs(ak.hi) + lift.hi + b_.hi * b_.hi) +
                                                           24 * slant_ * size_b_)) +
                         kTiny;
    const DoubleDouble far = sqrt(std::max(turn_ + error, DoubleDouble(0))) + slant_;
    edge_ = far / a_;
    edge_ = edge_ + 64 * kU2 * edge_.hi;
    const DoubleDouble wide = sqr(a_ * edge_ + slant_);
    bend_ = kPay * 12 * ((wide - turn_).hi + 2 * error + 64 * kU2 * (wide.hi + std::fabs(turn_.hi)));
    slack_ = kPay * 0.5 * bend_ * edge_.hi * edge_.hi + kTiny;
  }

  double tube_;
  DoubleDouble weight_;  ///< 4 R^2
  DoubleDouble a_, b_, k_, py_;
  double dy_;
  double size_b_ = 0, size_y_ = 0, error_k_ = 0, slant_ = 0, extent_ = 0;
  DoubleDouble centre_, turn_, edge_;
  double bend_ = 0, slack_ = 0;
  bool usable_ = false;
};

DoubleDouble clamp(const DoubleDouble& x, const DoubleDouble& lo, const DoubleDouble& hi) {
  return x < lo ? lo : x > hi ? hi : x;
}

enum class Side : std::uint8_t { unknown, inside, outside };

/// The lowest point of f on the side `sense` of the edge, and what it shows of f there.
struct Well {
  DoubleDouble z;
  Value value;
  Side side = Side::unknown;  ///< inside at z, or outside by more than the slack on the whole side
};

/// Halley's steps to the largest root of v^3 - 3 i v - j, then Newton's in double-double, the last one to
/// where f' leads away from the edge for certain.
Well well_of(const Line& line, double sense) {
  constexpr int kSteps = 40, kSharp = 3;
  const double i = line.cubic_i(), j = -sense * line.cubic_j();
  const double edge = line.edge().hi, most = std::max(line.extent(), edge);
  const auto h = [&](double v) { return (v * v - 3 * i) * v - j; };
  double v = std::sqrt(std::max(3 * i, 0.0)) + j / (i > 0 ? 6 * i : -3 * i);
  v = v >= edge && v <= most ? v : most;
  // h grows from the edge on: without a sign change f has no lowest point beyond it.
  if (h(edge) >= 0) v = edge;
  for (int n = 0; n < kSteps && v != edge; ++n) {
    const double dh = 3 * (v * v - i), under = dh * dh - 3 * h(v) * v;
    const double next = under != 0 ? std::clamp(v - h(v) * dh / under, edge, most) : edge;
    const double way = std::fabs(next - v);
    v = next;
    if (way <= 0x1p-50 * v) break;
  }
  Well well;
  DoubleDouble at = std::max(DoubleDouble(v), line.edge());
  well.value = line.value(sense * at);
  for (int n = 0; n < kSharp && well.value.ddf > 0; ++n) {
    const DoubleDouble slope = sense * well.value.df;
    const DoubleDouble next = clamp(at - (slope + 2 * well.value.slope_error) / well.value.ddf, line.edge(),
                                    std::max(DoubleDouble(most), line.edge()));
    const double way = std::fabs((next - at).hi);
    at = next;
    well.value = line.value(sense * at);
    if (way <= 0x1p-90 * at.hi || well.value.is_inside()) break;
  }
  well.z = sense * at;
  if (well.value.is_inside()) {
    well.side = Side::inside;
    return well;
  }
  // Towards the edge f lies above its tangent; away from it, where f'' grows, above its parabola.
  const double slope = sense * well.value.df.hi, error = well.value.slope_error;
  const double towards = std::max(slope + error, 0.0) * std::max((at - line.edge()).hi, 0.0);
  const double fall = std::max(error - slope, 0.0);
  const double by_extent = fall * std::max(line.extent() - at.hi, 0.0);
  const double away =
      line.is_bent(well.value, at) ? std::min(fall * fall / well.value.ddf, by_extent) : by_extent;
  if (well.value.is_outside(line.slack() + towards + away)) well.side = Side::outside;
  return well;
}

/// The crossing beside a well on its side `sense`, by Euler's steps; a bracket of which the signs are proved,
/// f above the slack outside.
std::optional<TorusCrossing> crossing(const Line& line, const Well& well, double sense) {
  constexpr int kSteps = 30, kSharp = 3, kWiden = 6;
  const double half = 0.5 * well.value.ddf, depth = -well.value.f.hi;
  // At an edge f'' vanishes: from as far as hits are.
  double e = half > 0 ? std::min(std::sqrt(depth / half), 2 * line.extent()) : line.extent();
  for (int n = 0; n < 3; ++n)
    e = std::sqrt(depth / std::max(half + line.lead() * e * (e + 4 * sense * well.z.hi), 0.25 * half));
  DoubleDouble at = well.z + sense * e;
  double last = std::numeric_limits<double>::infinity();
  Value value = line.value(at);
  for (int n = 0, sharp = 0; n < kSteps && sharp < kSharp; ++n) {
    const double f = value.f.hi, df = sense * value.df.hi;
    const double step = 2 * f / (df + std::sqrt(std::max(df * df - 2 * f * value.ddf, 0.0)));
    if (!std::isfinite(step)) return std::nullopt;
    at = at - sense * step;
    value = line.value(at);
    // Where steps no longer shrink the value is noise.
    if (std::fabs(step) <= 0x1p-60 * std::fabs(at.hi) || (std::fabs(step) >= last && n > 4)) ++sharp;
    last = std::fabs(step);
  }
  const double df = sense * value.df.hi;
  if (!(df > 0)) return std::nullopt;
  double width = 4 * (std::fabs(value.f.hi) + 2 * value.error + line.slack()) / df +
                 0x1p-100 * (std::fabs(at.hi) + std::fabs(line.centre().hi));
  for (int n = 0; n < kWiden; ++n, width *= 8) {
    const DoubleDouble out = at + sense * width, in = at - sense * width;
    // Less than a condition unit of l, where L >= 1 and |d| < 4: near a point where sheets cross f is flat.
    if (!(width <= 0x1p-52 * (std::fabs((at + line.centre()).hi) + 0.25))) return std::nullopt;
    // Between the well and the outside, and narrow against the way from the well.
    if (!(64 * width < std::fabs((at - well.z).hi))) return std::nullopt;
    if (line.value(out).is_outside(line.slack()) && line.value(in).is_inside())
      return sense > 0 ? TorusCrossing{in, out} : TorusCrossing{out, in};
  }
  return std::nullopt;
}

/// Whether f rises all the way from -edge to `end` or, beyond the edge, to wherever (sense 1; -1: reversed).
bool rises_until(const Line& line, const DoubleDouble& end, double sense) {
  const DoubleDouble at = sense * end < line.edge() ? end : sense * line.edge();
  const Value value = line.value(at);
  return sense * value.df.hi - value.slope_error > kPay * 2 * line.bend() * line.edge().hi;
}

/// Whether f is below zero from the well on the side -sense to `end`, where it is.
bool is_inside_until(const Line& line, const DoubleDouble& end, double sense) {
  // The side on which f is convex: below zero at both ends, below zero between.
  return sense * end < -line.edge() || rises_until(line, end, sense);
}

/// The highest point between two wells.
Side summit_of(const Line& line, DoubleDouble& top) {
  constexpr int kSteps = 20;
  const double i = line.cubic_i(), j = line.cubic_j(), edge = line.edge().hi;
  double at = 0;
  for (int n = 0; n < kSteps; ++n) {
    const double under = 3 * (at * at - i);
    if (under == 0) break;
    const double next = std::clamp(at - ((at * at - 3 * i) * at + j) / under, -edge, edge);
    if (next == at) break;
    at = next;
  }
  top = at;
  Value value = line.value(top);
  if (value.ddf < 0) {
    top = clamp(top - value.df / value.ddf, -line.edge(), line.edge());
    value = line.value(top);
  }
  if (value.is_outside()) return Side::outside;
  const double more =
      value.error + 2 * (std::fabs(value.df.hi) + value.slope_error) * line.edge().hi + 4 * line.slack();
  return value.f.hi < -kPay * more ? Side::inside : Side::unknown;
}

class Prover {
 public:
  Prover(const Line& line, bool first_only) : line_(line), first_only_(first_only) {
    answer_.centre = line.centre();
  }

  TorusLineAnswer run() {
    const Well left = well_of(line_, -1);
    if (left.side == Side::unknown) return answer_;
    if (left.side == Side::inside && !add(left, -1)) return answer_;
    if (is_enough()) return answer_;
    const Well right = well_of(line_, 1);
    if (right.side == Side::unknown) return answer_;
    if (left.side == Side::outside && right.side == Side::outside) {
      answer_.open = false;
    } else if (left.side == Side::inside && right.side == Side::inside) {
      two_wells(left, right);
    } else {
      one_well(left.side == Side::inside ? left : right, left.side == Side::inside ? -1 : 1);
    }
    return answer_;
  }

 private:
  bool add(const Well& well, double sense) {
    const auto found = crossing(line_, well, sense);
    if (!found) return false;
    answer_.crossings[answer_.count++] = *found;
    return true;
  }
  /// One crossing is found and asked for. Nothing lies before it: f > slack there.
  bool is_enough() {
    answer_.open = !(first_only_ && answer_.count == 1 && (answer_.crossings[0].lo + line_.centre()).hi > 0);
    return !answer_.open;
  }
  /// Four changes of sign are all; else the line is inside between the outer two.
  void two_wells(const Well& left, const Well& right) {
    DoubleDouble top;
    // What looks like a well at an edge from which f only rises is the way out of the other one.
    const bool is_one = rises_until(line_, right.z, 1) || rises_until(line_, left.z, -1);
    const Side summit = is_one ? Side::inside : summit_of(line_, top);
    if (summit == Side::unknown) return;
    if (summit == Side::outside && !(left.z < top && top < right.z && add(left, 1) && add(right, -1))) return;
    if (!add(right, 1)) return;
    answer_.open = !is_ascending();
  }
  /// The left well's first crossing is found already, or the right one's is to be.
  void one_well(const Well& well, double sense) {
    if (sense > 0) {
      if (!add(well, -1)) return;
      if (is_enough()) return;
    }
    if (!add(well, 1)) return;
    const TorusCrossing& inner = answer_.crossings[sense < 0 ? 1 : 0];
    answer_.open = !(is_ascending() && is_inside_until(line_, sense < 0 ? inner.lo : inner.hi, -sense));
  }
  [[nodiscard]] bool is_ascending() const {
    for (std::size_t i = 1; i < answer_.count; ++i) {
      if (!(answer_.crossings[i - 1].hi < answer_.crossings[i].lo)) return false;
    }
    return true;
  }

  const Line& line_;
  bool first_only_;
  TorusLineAnswer answer_;
};

}  // namespace

TorusLineAnswer prove_torus_line(const Ray& local, double ring, double tube, bool first_only) {
  const Line line(local, ring, tube);
  if (!line.is_usable()) return {};
  return Prover(line, first_only).run();
}

}  // namespace graze
