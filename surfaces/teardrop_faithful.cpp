#include <graze/surfaces/teardrop_faithful.hpp>

#include <cmath>
#include <limits>
#include <numeric>

#include <graze/solvers/certified.hpp>
#include <graze/solvers/math/scaling.hpp>
#include <graze/surfaces/nearest_doubles.hpp>
#include <graze/surfaces/teardrop_exact.hpp>

namespace graze {

TeardropFaithfulStep::TeardropFaithfulStep(const Teardrop& surface, const TeardropCertified& /*certified*/,
                                           const Parameters& options)
    : size_(surface.size()), set_(Certified::instruction_set(options)) {
  const int unit = surface.unit();
  frame_.m = surface.profile.m;
  // In units out of range the kernel for `certified` answers nothing either.
  if (unit > -1022 && unit < 1022) {
    frame_.unit = power_of_two(unit);
    frame_.inverse_unit = power_of_two(-unit);
  }
}

void TeardropFaithfulStep::correct(const FaithfulBatch& batch) const {
#if defined(__x86_64__)
  if (set_ == InstructionSet::avx512) return avx512::correct_teardrop(frame_, batch);
  if (set_ == InstructionSet::avx2) return avx2::correct_teardrop(frame_, batch);
#endif
  baseline::correct_teardrop(frame_, batch);
}

/// The exact tier: by the sides of points where it is known what to look for, else by all roots.
bool TeardropFaithfulStep::decide(const Ray& ray, bool all, std::span<const double> near,
                                  KernelAnswers& answers, std::size_t at) const {
  for (const bool is_known : {true, false}) {
    HitsOfRay hits(answers, at);
    if (!(is_known ? place(ray, all, near, hits) : isolate(ray, all, hits))) continue;
    hits.close(3);
    return true;
  }
  return false;
}

/// A line enters a convex solid once and leaves it once. Of one hit the origin is inside.
bool TeardropFaithfulStep::place(const Ray& ray, bool all, std::span<const double> near,
                                 HitsOfRay& hits) const {
  double last = 0;
  for (std::size_t k = 0; k < near.size(); ++k) {
    const double l = crossing_near(ray, near[k], k + 1 < near.size());
    if (!(l > last) || !hits.add(l, 1)) return false;
    if (!all) break;
    last = l;
  }
  return !near.empty();
}

/// A double within an ulp of where the line enters or leaves, looked for on both sides of l by exact signs; 0
/// where it is not found.
double TeardropFaithfulStep::crossing_near(const Ray& ray, double l, bool enters) const {
  constexpr double kFirst = 1, kWider = 8, kWidest = 4096;  // ulps
  if (!(l >= std::numeric_limits<double>::min() && l < 0x1p1000)) return 0;
  const auto is_before = [&](double x) { return side_of_teardrop(ray, size_, x) == (enters ? -1 : 1); };
  const auto is_behind = [&](double x) { return side_of_teardrop(ray, size_, x) == (enters ? 1 : -1); };
  double lo = l, hi = l, width = kFirst;
  for (bool found = false; !found; width *= kWider) {
    if (width > kWidest) return 0;
    lo = l - width * ulp(l);
    hi = l + width * ulp(l);
    found = is_before(lo) && is_behind(hi);
  }
  // Their middle is within an ulp of all that is between doubles two apart.
  for (double middle = std::midpoint(lo, hi); std::nextafter(lo, hi) < std::nextafter(hi, lo);
       middle = std::midpoint(lo, hi))
    (is_before(middle) ? lo : hi) = middle;
  return std::nextafter(lo, hi);
}

bool TeardropFaithfulStep::isolate(const Ray& ray, bool all, HitsOfRay& hits) const {
  std::vector<ExactHit> exact = exact_teardrop_hits(ray, size_);
  return add_nearest(exact, all, hits);
}

}  // namespace graze
