#include <algorithm>
#include <array>
#include <cmath>
#include <graze/experiments/truth_distance.hpp>

namespace graze::truth {
namespace {

using Point = std::array<Quad, 3>;

template <class T>
T horner(const std::vector<T>& c, const T& t) {
  T sum = 0;
  for (std::size_t i = c.size(); i-- > 0;) sum = sum * t + c[i];
  return sum;
}

Quad slope(const std::vector<Quad>& c, const Quad& t) {
  Quad sum = 0;
  for (std::size_t i = c.size(); i-- > 1;) sum = sum * t + c[i] * static_cast<int>(i);
  return sum;
}

/// M^-1 (p - T) by Cramer's rule.
Point to_object(const Placement& placement, Vec3 p) {
  const Vec3& t = placement.translate;
  const Point v{Quad(p.x) - t.x, Quad(p.y) - t.y, Quad(p.z) - t.z};
  if (placement.matrix == kIdentity) return v;
  const auto row = [&](std::size_t i) {
    const Vec3& m = placement.matrix[i];
    return Point{m.x, m.y, m.z};
  };
  const std::array<Point, 3> m{row(0), row(1), row(2)};
  Point adjugate_v{0, 0, 0};
  Quad determinant = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Point& a = m[(i + 1) % 3];
    const Point& b = m[(i + 2) % 3];
    for (std::size_t j = 0; j < 3; ++j) {
      const Quad cofactor = a[(j + 1) % 3] * b[(j + 2) % 3] - a[(j + 2) % 3] * b[(j + 1) % 3];
      adjugate_v[j] += cofactor * v[i];
      if (i == 0) determinant += cofactor * m[0][j];
    }
  }
  for (Quad& c : adjugate_v) c /= determinant;
  return adjugate_v;
}

Quad length(const Point& v) { return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

/// |M v|.
Quad world_length(const Placement& placement, const Point& v) {
  Point w;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3& m = placement.matrix[i];
    w[i] = m.x * v[0] + m.y * v[1] + m.z * v[2];
  }
  return length(w);
}

}  // namespace

ProfileDistance::ProfileDistance(std::vector<Quad> r, std::vector<Quad> y, const Placement& placement)
    : r_(std::move(r)), y_(std::move(y)), placement_(placement) {
  for (const Quad& c : r_) r_near_.push_back(static_cast<double>(c));
  for (const Quad& c : y_) y_near_.push_back(static_cast<double>(c));
}

/// Gauss-Newton for the foot point on (side R, Y), from a start nearby; it converges fast because the
/// distance is small where it matters.
Quad ProfileDistance::refine(double start, const Quad& rho, const Quad& height, int side) const {
  constexpr int kSteps = 12;
  Quad t = start;
  for (int i = 0; i < kSteps; ++i) {
    const Quad dr = side * slope(r_, t);
    const Quad dy = slope(y_, t);
    const Quad speed = dr * dr + dy * dy;
    if (speed == 0) break;
    const Quad step = ((side * horner(r_, t) - rho) * dr + (horner(y_, t) - height) * dy) / speed;
    const Quad next = std::clamp<Quad>(t - step, 0, 1);
    if (next == t) break;
    t = next;
  }
  return t;
}

double ProfileDistance::operator()(Vec3 point) const {
  const Point p = to_object(placement_, point);
  const Quad rho = sqrt(p[0] * p[0] + p[2] * p[2]);
  const double near_rho = static_cast<double>(rho);
  const double near_y = static_cast<double>(p[1]);
  // The local minima among samples of the profile and of its mirror image are where the foot point may be.
  constexpr int kSamples = 64;
  Quad best = std::numeric_limits<double>::infinity();
  for (const int side : {1, -1}) {
    std::array<double, kSamples + 1> gap;
    for (int i = 0; i <= kSamples; ++i) {
      const double t = static_cast<double>(i) / kSamples;
      gap[static_cast<std::size_t>(i)] =
          std::hypot(side * horner(r_near_, t) - near_rho, horner(y_near_, t) - near_y);
    }
    for (std::size_t i = 0; i <= kSamples; ++i) {
      const bool lowest = (i == 0 || gap[i] <= gap[i - 1]) && (i == kSamples || gap[i] <= gap[i + 1]);
      if (!lowest) continue;
      const Quad t = refine(static_cast<double>(i) / kSamples, rho, p[1], side);
      const Quad radius = side * horner(r_, t);
      const Quad out = rho == 0 ? Quad(1) : Quad(radius / rho);
      const Point foot{rho == 0 ? radius : Quad(p[0] * out), horner(y_, t),
                       rho == 0 ? Quad(0) : Quad(p[2] * out)};
      best = std::min<Quad>(best, world_length(placement_, {foot[0] - p[0], foot[1] - p[1], foot[2] - p[2]}));
    }
  }
  return static_cast<double>(best);
}

}  // namespace graze::truth
