#include <graze/surfaces/bezier_revolution_certified.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include <graze/solvers/certified.hpp>
#include <graze/solvers/math/double_double_ball.hpp>
#include <graze/surfaces/nearest_doubles.hpp>

namespace graze {
namespace {

using Ball = DoubleDoubleBall;
using Balls = std::vector<Ball>;

constexpr double kU = 0x1p-53;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Relative room in every bound that the lanes multiply with: over the roundings of a few operations.
constexpr double kRoom = 0x1p-40;

constexpr double kLeast = std::numeric_limits<double>::min();

double up(double x) { return x + kRoom * std::fabs(x); }
double down(double x) { return x - kRoom * std::fabs(x); }
double magnitude(const Ball& x) { return mag(x.enclosure()); }

/// Bernstein coefficients on [a, b] of the curve's coordinate on [0, 1]: the blossom's values.
Balls restricted(std::span<const double> control, const Ball& a, const Ball& b) {
  const std::size_t n = control.size() - 1;
  const Ball one(1.0);
  Balls result;
  for (std::size_t j = 0; j <= n; ++j) {
    Balls work(control.size());
    std::transform(control.begin(), control.end(), work.begin(), [](double v) { return Ball(v); });
    for (std::size_t level = 0; level < n; ++level) {
      const Ball& t = level < j ? b : a;
      for (std::size_t i = 0; i + level < n; ++i) work[i] = (one - t) * work[i] + t * work[i + 1];
    }
    result.push_back(work[0]);
  }
  return result;
}

/// n times the differences: Bernstein coefficients of the derivative.
Balls derivative(const Balls& b) {
  Balls d;
  const Ball n(static_cast<double>(b.size()) - 1);
  for (std::size_t i = 0; i + 1 < b.size(); ++i) d.push_back(n * (b[i + 1] - b[i]));
  if (d.empty()) d.emplace_back();
  return d;
}

// Scaled Bernstein coefficients C(n, i) b_i: products are convolutions, and ratios are those of the b_i.
Balls scaled(Balls b) {
  double binomial = 1;
  const auto n = static_cast<double>(b.size()) - 1;
  for (std::size_t i = 0; i < b.size(); ++i) {
    b[i] *= Ball(binomial);
    const auto k = static_cast<double>(i);
    binomial = binomial * (n - k) / (k + 1);
  }
  return b;
}

Balls operator*(const Balls& a, const Balls& b) {
  Balls c(a.size() + b.size() - 1);
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j) c[i + j] += a[i] * b[j];
  }
  return c;
}

/// The same polynomial with `size` coefficients: times 1.
Balls elevated(const Balls& a, std::size_t size) {
  return size <= a.size() ? a : a * scaled(Balls(size + 1 - a.size(), Ball(1.0)));
}

/// a - b, of different degrees.
Balls difference(const Balls& a, const Balls& b) {
  const std::size_t size = std::max(a.size(), b.size());
  Balls c = elevated(a, size);
  const Balls d = elevated(b, size);
  for (std::size_t i = 0; i < size; ++i) c[i] = c[i] - d[i];
  return c;
}

/// Range of numerator / denominator: a weighted mean of the ratios of their coefficients where the
/// denominator has one sign; coefficients that are zero in both have no weight. Unbounded where that fails.
Interval ratio_range(Balls numerator, Balls denominator, bool positive) {
  const std::size_t size = std::max(numerator.size(), denominator.size());
  numerator = elevated(numerator, size);
  denominator = elevated(denominator, size);
  Interval range(kInfinity, -kInfinity);
  for (std::size_t i = 0; i < size; ++i) {
    const Interval n = (positive ? numerator[i] : -numerator[i]).enclosure();
    const Interval d = (positive ? denominator[i] : -denominator[i]).enclosure();
    if (d.lo < 0) return {-kInfinity, kInfinity};
    if (n == Interval(0, 0) && d == Interval(0, 0)) continue;
    // Where both signs are sure the ratio is too; a coefficient of 0 below bounds one side only.
    const auto ratio_up = [&](double top) {
      if (top > 0) return d.lo > 0 ? div_up(top, d.lo) : kInfinity;
      return d.hi > 0 ? div_up(top, d.hi) : -kInfinity;
    };
    range = {std::min(range.lo, -ratio_up(-n.lo)), std::max(range.hi, ratio_up(n.hi))};
  }
  return {down(range.lo), up(range.hi)};
}

/// The control polygon is level at the end t = 0 or 1 of its curve.
bool is_level_at(std::span<const double> control, double t) {
  const std::size_t n = control.size() - 1;
  return t == 0 ? control[0] == control[1] : control[n] == control[n - 1];
}

/// A polynomial in sigma, t = origin + length sigma, with what the lanes need of it.
struct Local {
  std::array<double, kMaxBezierDegree + 1> c{};
  double tail = 0;              ///< what c[0] was rounded by
  double error = 0, step = 0;   ///< of the coefficients: of c[0], and of the others per sigma
  double rest = 0, second = 0;  ///< bounds of sum |c_i|, i > 0, and of the second derivative
};

/// Forward differences of the blossom. `turns`: the origin is an end of the profile where the derivative
/// vanishes, so that c_0 is the control value and c_1 = 0.
Local local_powers(std::span<const double> control, double origin, double length, bool turns) {
  constexpr double kPower = 1 + 0x1p-6;  // over (1 + 2^-10)^8
  Balls b = restricted(control, Ball(origin), Ball(origin) + Ball(length));
  const auto n = static_cast<double>(b.size()) - 1;
  Local local;
  double binomial = 1;
  for (std::size_t i = 0; i < control.size(); ++i) {
    Ball a = Ball(binomial) * b[0];
    if (turns && i == 0) a = Ball(origin == 0 ? control.front() : control.back());
    const bool vanishes = turns && i == 1;
    if (vanishes && is_level_at(control, origin)) a = {};
    const auto k = static_cast<double>(i);
    const double size = magnitude(a) * kPower;
    local.c[i] = a.value().hi;
    if (i == 0) {
      local.tail = a.value().lo;
      local.error = a.error() + 2 * kU * std::fabs(local.tail);
    } else {
      local.step += kPower * (a.error() + std::fabs(a.value().lo));
      local.rest += size;
    }
    local.second += k * (k - 1) * size;
    binomial = binomial * (n - k) / (k + 1);
    for (std::size_t j = 0; j + 1 < b.size(); ++j) b[j] = b[j + 1] - b[j];
    b.pop_back();
  }
  // Horner with n fma, a product, and the sums with the tail and c_0: n + 6 roundings of the smaller terms.
  local.step = up(local.step + kU * (n + 6) * local.rest);
  return local;
}

/// Where two intervals meet: a height, and G there.
struct Station {
  double t, y, g, error;
  bool is_turn = false;  ///< Y' = 0
  double slack = 0;      ///< how far t may be off: t of the height, or of the turn
};

/// About d2G/dy2: of the parabola through G at both ends and between them.
double mean_bend(const Local& y, const Local& r, const Station& low, const Station& high, double sigma) {
  const auto at = [sigma](const Local& p) {
    return std::accumulate(p.c.rbegin(), p.c.rend(), 0.0,
                           [sigma](double sum, double c) { return sum * sigma + c; });
  };
  const double height = high.y - low.y, share = (at(y) - low.y) / height;
  const double bulge = at(r) * at(r) - (low.g + share * (high.g - low.g));
  const double bend = -2 * bulge / (share * (1 - share) * height * height);
  return std::isfinite(bend) ? bend : 0;
}

class Builder {
 public:
  explicit Builder(const BezierProfile& profile) : r_(profile.r), y_(profile.y) {}

  [[nodiscard]] std::optional<Station> inner_station(double t, double reach, bool rising) const;
  [[nodiscard]] Station end_station(double t, double slack) const;
  [[nodiscard]] BezierInterval interval(const Station& a, const Station& b, bool rising) const;

 private:
  /// Part of the profile: scaled Bernstein coefficients of R, Y and their derivatives.
  struct Shape {
    Balls r, dr, ddr, y, dy, ddy;
    Balls hull;               ///< of R, not scaled
    bool is_cap_a, is_cap_b;  ///< leaves the axis horizontally
  };
  [[nodiscard]] Shape shape(const Ball& a, const Ball& b, bool turns_at_a, bool turns_at_b) const;
  [[nodiscard]] Shape shape(const Station& a, const Station& b) const;
  static Interval slope_range(const Shape& s, bool rising) {
    return ratio_range(twice(s.r * s.dr), s.dy, rising);
  }
  static Balls turn_numerator(const Shape& s);
  static bool is_concave(const Shape& s, bool rising);
  static Balls twice(Balls b) {
    for (Ball& x : b) x = x + x;
    return b;
  }

  std::span<const double> r_, y_;
};

Builder::Shape Builder::shape(const Ball& a, const Ball& b, bool turns_at_a, bool turns_at_b) const {
  const Balls r = restricted(r_, a, b), y = restricted(y_, a, b);
  const Balls dr = derivative(r);
  Balls dy = derivative(y);
  if (turns_at_a) dy.front() = {};
  if (turns_at_b) dy.back() = {};
  const bool is_cap_a = turns_at_a && r.front().is_exact_zero();
  const bool is_cap_b = turns_at_b && r.back().is_exact_zero();
  return {scaled(r), scaled(dr), scaled(derivative(dr)), scaled(y), scaled(dy), scaled(derivative(dy)), r,
          is_cap_a,  is_cap_b};
}

/// Between two stations, as far as their heights may lie; beyond a turn there is none.
Builder::Shape Builder::shape(const Station& a, const Station& b) const {
  const auto end = [](const Station& s, double outward) {
    if (s.is_turn || s.slack == 0) return Ball(DoubleDouble(s.t), s.slack);
    return Ball(s.t + outward * s.slack);
  };
  return shape(end(a, -1), end(b, 1), a.is_turn, b.is_turn);
}

/// The numerator of d(dG/dy) / dt = 2 ((R'^2 + R R'') Y' - R R' Y'') / Y'^2.
Balls Builder::turn_numerator(const Shape& s) {
  Balls minus = s.r * s.ddr;
  for (Ball& x : minus) x = -x;
  const Balls first = difference(s.dr * s.dr, minus) * s.dy;
  Balls numerator = twice(difference(first, s.r * s.dr * s.ddy));
  // At a cap, R = a t + ... and Y = c t^2 + ... give 2 a^2 c t - 2 a^2 c t + O(t^2): the first two
  // coefficients are exactly zero.
  const std::size_t last = numerator.size() - 1;
  const std::size_t next = std::min<std::size_t>(1, last);
  if (s.is_cap_a) numerator[0] = numerator[next] = {};
  if (s.is_cap_b) numerator[last] = numerator[last - next] = {};
  return numerator;
}

/// d2R/dy2 = (R'' Y' - R' Y'') / Y'^3 <= 0 where R >= 0, the other sign where R <= 0.
bool Builder::is_concave(const Shape& s, bool rising) {
  const auto all = [](const Balls& b, auto test) {
    return std::all_of(b.begin(), b.end(), [&](const Ball& x) { return test(x.enclosure()); });
  };
  const auto not_negative = [](Interval x) { return x.lo >= 0; };
  const auto not_positive = [](Interval x) { return x.hi <= 0; };
  if (!(rising ? all(s.dy, not_negative) : all(s.dy, not_positive))) return false;
  const Balls turn = difference(s.ddr * s.dy, s.dr * s.ddy);
  if (all(s.hull, not_negative)) return rising ? all(turn, not_positive) : all(turn, not_negative);
  if (all(s.hull, not_positive)) return rising ? all(turn, not_negative) : all(turn, not_positive);
  return false;
}

/// The height is Y(t) rounded: the profile reaches it within `reach` of t, which is proved.
std::optional<Station> Builder::inner_station(double t, double reach, bool rising) const {
  const Shape around = shape(Ball(t - reach), Ball(t + reach), false, false);
  const Interval before = around.y.front().enclosure(), behind = around.y.back().enclosure();
  const Ball r = restricted(r_, Ball(t), Ball(t)).front(), y = restricted(y_, Ball(t), Ball(t)).front();
  const double height = y.value().hi;
  const bool holds =
      rising ? before.hi < height && height < behind.lo : before.lo > height && height > behind.hi;
  const Ball g = r * r;
  const double error =
      mag(slope_range(around, rising)) * 2 * kU * std::fabs(height) + g.error() + kU * g.value().hi;
  if (!holds || !std::isfinite(error)) return std::nullopt;
  return Station{t, height, std::max(g.value().hi, kLeast), up(error), false, reach};
}

/// An end of a monotone piece: of the profile, or a turn of Y within `slack`.
Station Builder::end_station(double t, double slack) const {
  const Ball y = restricted(y_, Ball(t), Ball(t)).front();
  const Ball r = restricted(r_, Ball(DoubleDouble(t), slack), Ball(t)).front();
  const Ball g = r * r;
  const double error = g.error() + kU * g.value().hi;
  // A value of 0 says that G is exactly 0.
  const double value = g.is_exact_zero() ? 0 : std::max(g.value().hi, kLeast);
  const bool is_turn = slack > 0 || is_level_at(y_, t);
  return Station{t, y.value().hi, value, up(error), is_turn, slack};
}

BezierInterval Builder::interval(const Station& a, const Station& b, bool rising) const {
  // Beside a level end of the profile sigma counts from it: Y' is small there, and Y - y_0 keeps its digits.
  const bool from_a = a.is_turn && a.slack == 0, from_b = !from_a && b.is_turn && b.slack == 0;
  const double origin = from_a ? a.t : from_b ? b.t : 0.5 * (a.t + b.t);
  const double length = from_a ? b.t - a.t : from_b ? a.t - b.t : 0.5 * (b.t - a.t);
  const Local y = local_powers(y_, origin, length, from_a || from_b);
  const Local r = local_powers(r_, origin, length, from_a || from_b);
  const Shape s = shape(a, b);
  const Balls turn = turn_numerator(s), square = s.dy * s.dy;
  const Interval slope = slope_range(s, rising), bend = ratio_range(turn, square * s.dy, rising);
  // Of the part, a little more than `length` or twice that, which is 1 in sigma.
  const double turn_most = (from_a || from_b ? 1 : 0.5) * mag(ratio_range(turn, square, true));
  const Station& low = rising ? a : b;
  const Station& high = rising ? b : a;
  double smallest = kInfinity, largest = 0;
  for (const Ball& x : s.hull) {
    const Interval at = x.enclosure();
    smallest = std::min(smallest, s.hull.front().enclosure().lo > 0 ? at.lo : -at.hi);
    largest = std::max(largest, magnitude(x));
  }
  smallest = std::max(smallest, 0.0);
  BezierInterval i{};
  i.y_low = low.y, i.y_high = high.y;
  i.g_low = low.g, i.g_high = high.g;
  i.g_least = down(smallest * smallest), i.g_most = up(largest * largest);
  i.dg_low = slope.lo, i.dg_high = slope.hi;
  i.ddg_low = bend.lo, i.ddg_high = bend.hi;
  i.is_concave = is_concave(s, rising);
  const double sigma_low = (low.t - origin) / length, sigma_high = (high.t - origin) / length;
  const double ends[] = {
      low.y,         high.y,    low.g,     high.g, mean_bend(y, r, low, high, 0.5 * (sigma_low + sigma_high)),
      up(turn_most), sigma_low, sigma_high};
  const double ranges[] = {i.g_most, i.dg_low, i.dg_high, i.ddg_low, i.ddg_high, i.is_concave ? 1.0 : 0.0};
  const double errors[] = {y.tail, r.tail, y.error, y.step, r.error, r.step, up(y.second), up(r.second)};
  std::copy(std::begin(ends), std::end(ends), i.ends);
  std::copy(std::begin(ranges), std::end(ranges), i.ranges);
  std::copy(std::begin(errors), std::end(errors), i.errors);
  for (std::size_t k = 0; k <= kMaxBezierDegree; ++k) {
    i.powers[2 * k] = y.c[k];
    i.powers[2 * k + 1] = r.c[k];
  }
  return i;
}

}  // namespace

BezierRevolutionCertified::BezierRevolutionCertified(const BezierRevolution& surface,
                                                     const Parameters& options)
    : unit_(surface.unit()), set_(Certified::instruction_set(options)) {
  if (surface.profile.r.size() > BezierDoubleDouble::kMaxDegree + 1) return;
  exact_.emplace(surface.control_points);
  if (!surface.is_exact_in_unit()) return;
  double_doubles_.emplace(surface.profile);
  prepare_lanes(surface.profile, scale_by_power(surface.size(), -unit_));
}

void BezierRevolutionCertified::prepare_lanes(const BezierProfile& profile, double size) {
  for (const double y : profile.y) frame_.y_size = std::max(frame_.y_size, std::fabs(y));
  frame_.degree = profile.r.size() - 1;
  if (profile.flat || frame_.degree > kMaxBezierDegree || frame_.y_size > 2 * size) return;
  for (const MonotonePiece& piece : profile.pieces) {
    if (!add_track(profile, piece)) {
      intervals_.clear();
      return;
    }
  }
  for (const BezierInterval& interval : intervals_) frame_.g_most = std::max(frame_.g_most, interval.g_most);
  frame_.inverse_unit = power_of_two(-unit_);
  frame_.middle = 0.5 * (profile.cylinder.y_lo + profile.cylinder.y_hi);
}

/// A piece's intervals, upward; false where they cannot be had.
bool BezierRevolutionCertified::add_track(const BezierProfile& profile, const MonotonePiece& piece) {
  constexpr double kParts = 16;  // of [0, 1]: surfaces/bezier_revolution.md, "Kernel"
  const Builder builder(profile);
  const double length = piece.t_hi - piece.t_lo;
  const int parts = std::max(2, static_cast<int>(std::ceil(kParts * length)));
  const double reach = 0x1p-20 * length / parts;
  std::vector<Station> stations{builder.end_station(piece.t_lo, piece.slack_lo)};
  for (int k = 1; k < parts; ++k) {
    const auto station = builder.inner_station(piece.t_lo + length * k / parts, reach, piece.rising);
    if (!station) return false;
    stations.push_back(*station);
  }
  stations.push_back(builder.end_station(piece.t_hi, piece.slack_hi));
  for (const Station& station : stations) frame_.g_error = std::max(frame_.g_error, station.error);

  const std::size_t begin = intervals_.size();
  for (std::size_t k = 0; k + 1 < stations.size(); ++k) {
    intervals_.push_back(builder.interval(stations[k], stations[k + 1], piece.rising));
  }
  if (!piece.rising) std::reverse(intervals_.begin() + static_cast<std::ptrdiff_t>(begin), intervals_.end());
  tracks_.push_back({begin, intervals_.size()});
  return intervals_.size() <= kMaxBezierIntervals;
}

void BezierRevolutionCertified::intersect(std::span<const Ray> rays, bool all, KernelAnswers& answers,
                                          std::size_t first) const {
  static_assert(BezierAnswers::kMost <= KernelAnswers::kMost);
  BezierAnswers to{.hits = &answers.hits[first]};
  for (std::size_t k = 0; k < BezierAnswers::kMost; ++k) to.l[k] = &answers.l[k][first];
  std::fill_n(to.hits, rays.size(), KernelAnswers::kOpen);
  if (!intervals_.empty()) run_lanes(rays, all, to);
  if (!exact_) return;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (to.hits[i] == KernelAnswers::kOpen && is_valid(rays[i])) decide(rays[i], all, answers, first + i);
  }
}

void BezierRevolutionCertified::run_lanes(std::span<const Ray> rays, bool all,
                                          const BezierAnswers& to) const {
  BezierBatch batch = frame_;
  batch.rays = rays.data();
  batch.count = rays.size();
  batch.both = all;
  batch.intervals = intervals_.data();
  batch.tracks = tracks_.data();
  batch.track_count = tracks_.size();
#if defined(__x86_64__)
  if (set_ == InstructionSet::avx512) return avx512::intersect_bezier(batch, to);
  if (set_ == InstructionSet::avx2) return avx2::intersect_bezier(batch, to);
#endif
  baseline::intersect_bezier(batch, to);
}

bool BezierRevolutionCertified::find_in_double_doubles(const Ray& ray, BezierDoubleDouble::Hits& found,
                                                       int& l_exponent) const {
  if (!double_doubles_) return false;
  const LocalRay local = to_unit(ray, unit_);
  // What the change of units rounds is left to the last tier.
  if (scale_by_power(local.o, unit_) != ray.o) return false;
  if (scale_by_power(local.d, unit_ - local.l_exponent) != ray.d) return false;
  l_exponent = local.l_exponent;
  return double_doubles_->find(local.o, local.d, found);
}

bool BezierRevolutionCertified::add_double_doubles(const Ray& ray, bool all, HitsOfRay& hits) const {
  BezierDoubleDouble::Hits found;
  int l_exponent = 0;
  if (!find_in_double_doubles(ray, found, l_exponent)) return false;
  if (!all) found.count = std::min<std::size_t>(found.count, 1);
  for (std::size_t k = 0; k < found.count; ++k) {
    const BezierDoubleDouble::Hit& hit = found.list[k];
    if (!hits.add(scale_by_power(hit.l.hi, l_exponent), hit.multiplicity)) return false;
  }
  return true;
}

/// The rays that doubles leave. Every question has an answer, but for an l out of the range of double.
void BezierRevolutionCertified::decide(const Ray& ray, bool all, KernelAnswers& answers,
                                       std::size_t at) const {
  HitsOfRay fast(answers, at);
  if (add_double_doubles(ray, all, fast)) return fast.close(2);
  ExactBezierRevolution::Hits found = exact_->hits(ray);
  HitsOfRay hits(answers, at);
  if (!found) return hits.close_coincident(3);
  if (add_nearest(*found, all, hits)) hits.close(3);
}

}  // namespace graze
