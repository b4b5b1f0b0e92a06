#include <graze/surfaces/bezier_revolution_faithful.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include <graze/solvers/certified.hpp>
#include <graze/solvers/math/double_double_ball.hpp>
#include <graze/solvers/math/scaling.hpp>
#include <graze/surfaces/nearest_doubles.hpp>

namespace graze {
namespace {

using Ball = DoubleDoubleBall;

constexpr double kU = 0x1p-53;
constexpr double kRoom = 1 + 0x1p-40;  // over the roundings of a bound

/// Powers of tau from an end's control values: forward differences, in double-double. `first` grows by a
/// bound of the sizes that the derivative is a sum of.
BezierPowers powers_of(const std::vector<double>& control, double& first) {
  const std::size_t n = control.size() - 1;
  const auto points = static_cast<double>(n + 1);
  // Roundings of Horner's rule and of the difference that follows: surfaces/bezier_revolution.md.
  const double units = (1.5 * points * (points + 1) + 16 * points) * kU * kU;
  std::vector<Ball> b(control.begin(), control.end());
  BezierPowers powers;
  double binomial = 1, tau = 1;
  for (std::size_t i = 0; i <= n; ++i) {
    const Ball c = Ball(binomial) * b[0];
    powers.c[i] = c.value().hi;
    powers.tail[i] = c.value().lo;
    const auto k = static_cast<double>(i);
    const double size = kRoom * (std::fabs(c.value().hi) + c.error()), error = units * size + c.error();
    if (i == 0) {
      powers.error = kRoom * error;
    } else {
      powers.step += kRoom * error * tau;
      first += kRoom * k * size * tau;
      tau *= BezierPowers::kMostTau;
    }
    binomial = binomial * (points - 1 - k) / (k + 1);
    for (std::size_t j = 0; j + 1 < b.size(); ++j) b[j] = b[j + 1] - b[j];
    b.pop_back();
  }
  return powers;
}

/// A bound of the second derivative on [0, 1]: n (n - 1) times the largest second difference.
double second_bound(const std::vector<double>& control) {
  const auto n = static_cast<double>(control.size()) - 1;
  double most = 0;
  for (std::size_t i = 0; i + 2 < control.size(); ++i) {
    const Ball difference =
        (Ball(control[i]) - Ball(control[i + 1])) - (Ball(control[i + 1]) - Ball(control[i + 2]));
    most = std::max(most, std::fabs(difference.value().hi) + difference.error());
  }
  return kRoom * n * (n - 1) * most;
}

/// About the end where Y' is smaller, so that the root of its parabola is real; it meets both ends.
BezierCell cell_of(const BezierProfile& profile, double a, double b) {
  const ProfilePoint at_a = profile.at(a), at_b = profile.at(b);
  const bool is_back = a + b > 1, from_a = std::fabs(at_a.dy) < std::fabs(at_b.dy);
  const ProfilePoint& from = from_a ? at_a : at_b;
  const double t = from_a ? a : b, length = b - a, slope = std::fabs(from.dy);
  const double bend = (std::fabs(at_b.y - at_a.y) - slope * length) / (length * length);
  return {from.y, is_back ? 1 - t : t, slope, bend, from_a == is_back ? -1.0 : 1.0, is_back ? 1.0 : 0.0};
}

BezierMonotone monotone_of(const BezierProfile& profile, const MonotonePiece& piece) {
  constexpr std::size_t kCells = BezierMonotone::kCells;
  BezierMonotone m;
  m.y_low = piece.y_lo, m.y_high = piece.y_hi;
  m.t_low = piece.t_lo, m.t_high = piece.t_hi;
  const double length = (piece.t_hi - piece.t_lo) / static_cast<double>(kCells);
  for (std::size_t k = 0; k < kCells; ++k) {
    const std::size_t from = piece.rising ? k : kCells - 1 - k;
    const double a = piece.t_lo + length * static_cast<double>(from);
    const double b = from + 1 == kCells ? piece.t_hi : piece.t_lo + length * static_cast<double>(from + 1);
    m.cells[k] = cell_of(profile, a, b);
    if (k + 1 < kCells) m.tops[k] = profile.at(piece.rising ? b : a).y;
  }
  return m;
}

/// Whether the double next to the proved hit is within an ulp of it, on both sides.
bool is_placed(const BezierDoubleDouble::Hit& hit) {
  constexpr double kOver = 0x1p-10;  // over the roundings of this line
  const double gap = hit.l.hi - std::nextafter(hit.l.hi, 0.0);
  return std::fabs(hit.l.lo) + hit.error < (1 - kOver) * gap;
}

}  // namespace

BezierRevolutionFaithfulStep::BezierRevolutionFaithfulStep(const BezierRevolution& surface,
                                                           const BezierRevolutionCertified& certified,
                                                           const Parameters& options)
    : certified_(certified), set_(Certified::instruction_set(options)) {
  const BezierProfile& profile = surface.profile;
  if (profile.flat || profile.r.size() > kMaxFaithfulBezierDegree + 1 || !surface.is_exact_in_unit()) return;
  frame_.unit = power_of_two(surface.unit());
  frame_.inverse_unit = power_of_two(-surface.unit());
  frame_.degree = profile.r.size() - 1;
  for (const bool is_back : {false, true}) {
    std::vector<double> heights = profile.y, radii = profile.r;
    if (is_back) std::reverse(heights.begin(), heights.end());
    if (is_back) std::reverse(radii.begin(), radii.end());
    frame_.ends[is_back ? 1 : 0] = {powers_of(heights, frame_.y_first), powers_of(radii, frame_.r_first)};
  }
  frame_.y_second = second_bound(profile.y), frame_.r_second = second_bound(profile.r);
  for (const MonotonePiece& piece : profile.pieces) pieces_.push_back(monotone_of(profile, piece));
}

void BezierRevolutionFaithfulStep::correct(const FaithfulBatch& batch) const {
  if (pieces_.empty()) {
    for (std::size_t i = 0; i < batch.count; ++i) batch.open[batch.which[i]] = 1;
    return;
  }
  BezierFaithfulFrame frame = frame_;
  frame.pieces = pieces_.data();
  frame.count = pieces_.size();
#if defined(__x86_64__)
  if (set_ == InstructionSet::avx512) return avx512::correct_bezier(frame, batch);
  if (set_ == InstructionSet::avx2) return avx2::correct_bezier(frame, batch);
#endif
  baseline::correct_bezier(frame, batch);
}

/// Double-doubles, then exact integers: all hits of the ray again, with their enclosures.
bool BezierRevolutionFaithfulStep::decide(const Ray& ray, bool all, std::span<const double> /*near*/,
                                          KernelAnswers& answers, std::size_t at) const {
  HitsOfRay fast(answers, at);
  if (place(ray, all, fast)) {
    fast.close(2);
    return true;
  }
  HitsOfRay exact(answers, at);
  ExactBezierRevolution::Hits found = certified_.exact_hits(ray);
  if (!found || !add_nearest(*found, all, exact)) return false;
  exact.close(3);
  return true;
}

/// By double-doubles; false where they do not tell. Hits that are nearest to one double are for exact
/// numbers.
bool BezierRevolutionFaithfulStep::place(const Ray& ray, bool all, HitsOfRay& hits) const {
  BezierDoubleDouble::Hits found;
  int l_exponent = 0;
  if (!certified_.find_in_double_doubles(ray, found, l_exponent)) return false;
  for (std::size_t k = 0; k < found.count; ++k) {
    const BezierDoubleDouble::Hit& hit = found.list[k];
    const double l = scale_by_power(hit.l.hi, l_exponent);
    // A subnormal l would be rounded again.
    if (!is_placed(hit) || !(l >= std::numeric_limits<double>::min())) return false;
    if (k > 0 && !(hit.l.hi > found.list[k - 1].l.hi)) return false;
    if (!hits.add(l, hit.multiplicity)) return false;
    if (!all) return k + 1 == found.count || found.list[k + 1].l.hi > hit.l.hi;
  }
  return found.count > 0;
}

}  // namespace graze
