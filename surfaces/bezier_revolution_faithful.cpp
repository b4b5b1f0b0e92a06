#include <graze/surfaces/bezier_revolution_faithful.hpp>

#include <cmath>
#include <limits>

#include <graze/surfaces/nearest_doubles.hpp>

namespace graze {
namespace {

/// Whether the double next to the proved hit is within an ulp of it, on both sides.
bool is_placed(const BezierDoubleDouble::Hit& hit) {
  constexpr double kRoom = 0x1p-10;  // over the roundings of this line
  const double gap = hit.l.hi - std::nextafter(hit.l.hi, 0.0);
  return std::fabs(hit.l.lo) + hit.error < (1 - kRoom) * gap;
}

}  // namespace

void BezierRevolutionFaithful::intersect(std::span<const Ray> rays, bool all, KernelAnswers& answers,
                                         std::size_t first) const {
  certified_.intersect(rays, all, answers, first);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (answers.hits[first + i] <= 0) continue;
    HitsOfRay fast(answers, first + i);
    if (place(rays[i], all, fast)) {
      fast.close(2);
      continue;
    }
    HitsOfRay exact(answers, first + i);
    ExactBezierRevolution::Hits found = certified_.exact_hits(rays[i]);
    if (found && add_nearest(*found, all, exact)) {
      exact.close(3);
    } else {
      answers.hits[first + i] = KernelAnswers::kOpen;
    }
  }
}

/// By double-doubles; false where they do not tell. Hits that are nearest to one double are for exact
/// numbers.
bool BezierRevolutionFaithful::place(const Ray& ray, bool all, HitsOfRay& hits) const {
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
