#include <algorithm>
#include <graze/experiments/truth_foot_point.hpp>
#include <limits>

namespace graze::truth {
namespace {

constexpr std::array<std::size_t, 3> kAxes{0, 1, 2};

Wide inner(const WidePoint& a, const WidePoint& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Wide length(const WidePoint& a) { return sqrt(inner(a, a)); }
WidePoint operator+(const WidePoint& a, const WidePoint& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
WidePoint operator-(const WidePoint& a, const WidePoint& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
WidePoint operator*(const Wide& k, const WidePoint& a) { return {k * a[0], k * a[1], k * a[2]}; }
WidePoint cross(const WidePoint& a, const WidePoint& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Wide norm(const WideMatrix& a) { return sqrt(inner(a[0], a[0]) + inner(a[1], a[1]) + inner(a[2], a[2])); }
WidePoint wide(Vec3 v) { return {Wide(v.x), Wide(v.y), Wide(v.z)}; }

/// 2^-bits.
Wide power_of_half(int bits) { return ldexp(Wide(1), -bits); }

/// By Cramer's rule.
WideMatrix inverse(const Mat3& matrix) {
  const WideMatrix m{wide(matrix[0]), wide(matrix[1]), wide(matrix[2])};
  WideMatrix result;
  Wide det = 0;
  for (const std::size_t i : kAxes) {
    const WidePoint& a = m[(i + 1) % 3];
    const WidePoint& b = m[(i + 2) % 3];
    for (const std::size_t j : kAxes) {
      result[j][i] = a[(j + 1) % 3] * b[(j + 2) % 3] - a[(j + 2) % 3] * b[(j + 1) % 3];
      if (i == 0) det += result[j][i] * m[0][j];
    }
  }
  for (auto& row : result)
    for (auto& c : row) c /= det;
  return result;
}

/// Linear equations of n unknowns by elimination with the largest pivot; none when they are singular.
template <std::size_t n>
std::optional<std::array<Wide, n>> solve(std::array<std::array<Wide, n>, n> a, std::array<Wide, n> b) {
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < n; ++i)
      if (abs(a[i][k]) > abs(a[pivot][k])) pivot = i;
    if (a[pivot][k] == 0) return std::nullopt;
    std::swap(a[k], a[pivot]);
    std::swap(b[k], b[pivot]);
    for (std::size_t i = k + 1; i < n; ++i) {
      const Wide factor = a[i][k] / a[k][k];
      for (std::size_t j = k + 1; j < n; ++j) a[i][j] -= factor * a[k][j];
      b[i] -= factor * b[k];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = k + 1; j < n; ++j) b[k] -= a[k][j] * b[j];
    b[k] /= a[k][k];
  }
  return b;
}

/// Eigenvalues and rows of eigenvectors of a symmetric matrix by Jacobi's rotations.
void diagonalise(WideMatrix& a, WideMatrix& vectors) {
  // Convergence is quadratic; ten sweeps are twice what 237 bits take. 2^-230 is rounding.
  constexpr int kSweeps = 10;
  vectors = {WidePoint{1, 0, 0}, WidePoint{0, 1, 0}, WidePoint{0, 0, 1}};
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (const std::size_t i : kAxes) {
      const std::size_t j = (i + 1) % 3;
      if (abs(a[i][j]) <= power_of_half(230) * (abs(a[i][i]) + abs(a[j][j]))) continue;
      const Wide theta = (a[j][j] - a[i][i]) / (2 * a[i][j]);
      const Wide t = (theta < 0 ? -1 : 1) / (abs(theta) + sqrt(theta * theta + 1));
      const Wide c = 1 / sqrt(t * t + 1);
      const Wide s = t * c;
      for (const std::size_t k : kAxes) {
        const Wide u = a[k][i];
        const Wide v = a[k][j];
        a[k][i] = c * u - s * v;
        a[k][j] = s * u + c * v;
      }
      const WidePoint row_i = a[i];
      const WidePoint row_j = a[j];
      a[i] = c * row_i - s * row_j;
      a[j] = s * row_i + c * row_j;
      const WidePoint vector_i = vectors[i];
      const WidePoint vector_j = vectors[j];
      vectors[i] = c * vector_i - s * vector_j;
      vectors[j] = s * vector_i + c * vector_j;
    }
  }
}

/// The shortest step s with a s = b in the least-squares sense.
WidePoint least_squares(WideMatrix a, const WidePoint& b) {
  // An eigenvalue 2^-100 of the largest is a zero that was rounded.
  constexpr int kRankBits = 100;
  WideMatrix vectors;
  diagonalise(a, vectors);
  Wide largest = 0;
  for (const std::size_t i : kAxes) largest = std::max<Wide>(largest, abs(a[i][i]));
  WidePoint step{0, 0, 0};
  for (const std::size_t i : kAxes)
    if (abs(a[i][i]) > largest * power_of_half(kRankBits))
      step = step + (inner(vectors[i], b) / a[i][i]) * vectors[i];
  return step;
}

}  // namespace

FootPointDistance::FootPointDistance(std::vector<Term> terms, const Placement& placement)
    : terms_(std::move(terms)),
      inverse_(inverse(placement.matrix)),
      translate_(wide(placement.translate)),
      identity_(placement.matrix == kIdentity) {
  for (const Term& term : terms_)
    for (const std::size_t i : kAxes) top_[i] = std::max(top_[i], term.powers[i]);
}

/// The powers of x with their first and second derivatives, and those of |x|.
struct FootPointDistance::Powers {
  Powers(const Wide& x, int top) {
    std::vector<Wide> power{Wide(1)};
    for (int k = 0; k < top; ++k) power.push_back(power.back() * x);
    for (int k = 0; k <= top; ++k) {
      const auto i = static_cast<std::size_t>(k);
      order[0].push_back(power[i]);
      order[1].push_back(k < 1 ? Wide(0) : Wide(k * power[i - 1]));
      order[2].push_back(k < 2 ? Wide(0) : Wide(k * (k - 1) * power[i - 2]));
      size.push_back(abs(power[i]));
    }
  }
  std::array<std::vector<Wide>, 3> order;
  std::vector<Wide> size;
};

/// Sums over x of sums over y of sums over z, each with the derivatives up to the second.
FootPointDistance::Value FootPointDistance::in_object(const WidePoint& at) const {
  const Powers x(at[0], top_[0]), y(at[1], top_[1]), z(at[2], top_[2]);
  using Jet = std::array<std::array<std::array<Wide, 3>, 3>, 3>;
  Jet whole{};  // [order in x][in y][in z]
  Wide noise = 0;
  for (std::size_t first = 0; first < terms_.size();) {
    const auto i = static_cast<std::size_t>(terms_[first].powers[0]);
    std::array<std::array<Wide, 3>, 3> of_yz{};
    Wide noise_yz = 0;
    while (first < terms_.size() && terms_[first].powers[0] == static_cast<int>(i)) {
      const auto j = static_cast<std::size_t>(terms_[first].powers[1]);
      std::array<Wide, 3> of_z{};
      Wide noise_z = 0;
      for (; first < terms_.size() && terms_[first].powers[0] == static_cast<int>(i) &&
             terms_[first].powers[1] == static_cast<int>(j);
           ++first) {
        const auto k = static_cast<std::size_t>(terms_[first].powers[2]);
        for (const std::size_t c : kAxes) of_z[c] += terms_[first].c * z.order[c][k];
        noise_z += abs(terms_[first].c) * z.size[k];
      }
      for (const std::size_t b : kAxes)
        for (std::size_t c = 0; b + c < 3; ++c) of_yz[b][c] += y.order[b][j] * of_z[c];
      noise_yz += y.size[j] * noise_z;
    }
    for (const std::size_t a : kAxes)
      for (std::size_t b = 0; a + b < 3; ++b)
        for (std::size_t c = 0; a + b + c < 3; ++c) whole[a][b][c] += x.order[a][i] * of_yz[b][c];
    noise += x.size[i] * noise_yz;
  }
  // 200 of 237 bits: the rest covers the number of operations.
  return {whole[0][0][0],
          noise * power_of_half(200),
          {whole[1][0][0], whole[0][1][0], whole[0][0][1]},
          {WidePoint{whole[2][0][0], whole[1][1][0], whole[1][0][1]},
           WidePoint{whole[1][1][0], whole[0][2][0], whole[0][1][1]},
           WidePoint{whole[1][0][1], whole[0][1][1], whole[0][0][2]}}};
}

FootPointDistance::Value FootPointDistance::evaluate(const WidePoint& world) const {
  const WidePoint from = world - translate_;
  if (identity_) return in_object(from);
  Value value = in_object({inner(inverse_[0], from), inner(inverse_[1], from), inner(inverse_[2], from)});
  const WidePoint g = value.gradient;
  const WideMatrix h = value.hessian;
  // With X = A w the chain rule gives A^T g and A^T H A.
  WideMatrix h_a{};
  for (const std::size_t k : kAxes)
    h_a[k] = h[k][0] * inverse_[0] + h[k][1] * inverse_[1] + h[k][2] * inverse_[2];
  value.gradient = g[0] * inverse_[0] + g[1] * inverse_[1] + g[2] * inverse_[2];
  for (const std::size_t i : kAxes)
    value.hessian[i] = inverse_[0][i] * h_a[0] + inverse_[1][i] * h_a[1] + inverse_[2][i] * h_a[2];
  return value;
}

/// Newton's method for p - x = lambda grad f, f = 0. With lambda = 0 the first step is |f| / |grad f| along
/// the gradient.
FootPointDistance::Foot FootPointDistance::newton(const WidePoint& p, WidePoint x, Wide multiplier) const {
  constexpr int kSteps = 40;
  // Below 2^-100 of the distance the next step, quadratically smaller, is below rounding; a step below 2^-200
  // of the coordinates is rounding already.
  const Wide fine = power_of_half(100);
  const Wide finest = power_of_half(200) * (length(x) + length(translate_));
  Foot foot{x, 0, 0, 0};
  for (int i = 0; i < kSteps && !foot.converged; ++i) {
    const Value value = evaluate(x);
    const WidePoint& g = value.gradient;
    if (i == 0) foot.first_step = value.f == 0 ? Wide(0) : Wide(abs(value.f) / length(g));
    std::array<std::array<Wide, 4>, 4> a;
    for (const std::size_t r : kAxes) {
      for (const std::size_t c : kAxes) a[r][c] = multiplier * value.hessian[r][c] + (r == c ? 1 : 0);
      a[r][3] = g[r];
      a[3][r] = g[r];
    }
    a[3][3] = 0;
    const WidePoint rest = p - x;
    const auto step = solve<4>(a, {rest[0], rest[1], rest[2], Wide(-value.f)});
    if (!step) return foot;
    const WidePoint dx{(*step)[0], (*step)[1], (*step)[2]};
    multiplier = (*step)[3];
    x = x + dx;
    const Wide size = length(dx);
    foot.converged = size <= finest || size <= fine * length(x - p);
    foot.curving = abs(multiplier) * norm(value.hessian);
  }
  foot.x = x;
  foot.distance = length(x - p);
  return foot;
}

/// The distance grows in every direction along the surface: I + lambda H is positive definite there.
bool FootPointDistance::is_minimum(const WidePoint& p, const WidePoint& x) const {
  const Value value = evaluate(x);
  const WidePoint& g = value.gradient;
  const Wide squared = inner(g, g);
  if (squared == 0) return false;
  const Wide multiplier = inner(g, p - x) / squared;
  // Two tangents: across the axis that the gradient is farthest from, and across both.
  const auto least = static_cast<std::size_t>(
      std::min_element(g.begin(), g.end(), [](const Wide& a, const Wide& b) { return abs(a) < abs(b); }) -
      g.begin());
  WidePoint axis{0, 0, 0};
  axis[least] = 1;
  const WidePoint u = cross(g, axis);
  const WidePoint v = cross(g, u);
  const auto form = [&](const WidePoint& a, const WidePoint& b) -> Wide {
    const WidePoint h_b{inner(value.hessian[0], b), inner(value.hessian[1], b), inner(value.hessian[2], b)};
    return inner(a, b) + multiplier * inner(a, h_b);
  };
  return form(u, u) > 0 && form(u, u) * form(v, v) > form(u, v) * form(u, v);
}

std::optional<double> FootPointDistance::near(Vec3 point) const {
  const WidePoint p = wide(point);
  const Value value = evaluate(p);
  if (value.f == 0) return 0.0;
  if (inner(value.gradient, value.gradient) == 0) return std::nullopt;
  const Foot foot = newton(p, p, 0);
  // Half a radius of curvature away and as far as the first step said: the foot point is the nearest one.
  const bool sure = foot.converged && 2 * foot.curving <= 1 && 2 * foot.distance <= 3 * foot.first_step;
  if (!sure) return std::nullopt;
  return static_cast<double>(foot.distance);
}

/// Newton steps along the gradient; none when they do not arrive.
std::optional<WidePoint> FootPointDistance::onto_surface(WidePoint x) const {
  // Far away a step takes 1 / degree of the way, near the surface the number of right bits doubles.
  constexpr int kSteps = 200;
  for (int i = 0; i < kSteps; ++i) {
    const Value value = evaluate(x);
    if (abs(value.f) <= value.noise) return x;
    const Wide squared = inner(value.gradient, value.gradient);
    if (squared == 0) break;
    x = x - (value.f / squared) * value.gradient;
  }
  return std::nullopt;
}

/// Slides along the surface as long as the distance falls.
WidePoint FootPointDistance::descend(const WidePoint& p, WidePoint x) const {
  constexpr int kSteps = 24;
  constexpr int kHalvings = 4;
  Wide distance = length(x - p);
  for (int i = 0; i < kSteps; ++i) {
    const Value value = evaluate(x);
    const WidePoint& g = value.gradient;
    const Wide squared = inner(g, g);
    if (squared == 0) break;
    const WidePoint rest = p - x;
    const Wide multiplier = inner(g, rest) / squared;
    WidePoint slide = rest - multiplier * g;
    // Where sliding hardly shortens the distance Newton's method takes over.
    if (length(slide) * 1024 <= distance) break;
    // On a surface that curves away from p the foot point is nearer than the tangent plane says.
    slide = (1 / (1 + abs(multiplier) * norm(value.hessian))) * slide;
    bool shorter = false;
    for (int k = 0; k < kHalvings && !shorter; ++k) {
      const auto next = onto_surface(x + slide);
      shorter = next && length(*next - p) < distance;
      if (shorter) x = *next;
      if (shorter) distance = length(x - p);
      slide = Wide(0.5) * slide;
    }
    if (!shorter) break;
  }
  return x;
}

/// Newton's method for grad f = 0, a few steps of it.
WidePoint FootPointDistance::critical_point(const WidePoint& p) const {
  // One step for quadrics; the rest is for higher degrees, whose steps may only halve the gap.
  constexpr int kSteps = 16;
  const Wide finest = power_of_half(200);
  WidePoint x = p;
  for (int i = 0; i < kSteps; ++i) {
    const Value value = evaluate(x);
    const WidePoint step = least_squares(value.hessian, value.gradient);
    x = x - step;
    if (length(step) <= finest * length(x - p)) break;
  }
  return x;
}

Vec3 FootPointDistance::center(Vec3 point) const {
  const WidePoint c = critical_point(wide(point));
  return {static_cast<double>(c[0]), static_cast<double>(c[1]), static_cast<double>(c[2])};
}

/// The least distance on the way down from a point of the surface.
Wide FootPointDistance::distance_from(const WidePoint& p, const WidePoint& start) const {
  const auto foot_of = [&](const WidePoint& x) {
    const WidePoint g = evaluate(x).gradient;
    const Wide squared = inner(g, g);
    return squared == 0 ? Foot{} : newton(p, x, inner(g, p - x) / squared);
  };
  const Wide known = length(start - p);
  const Foot direct = foot_of(start);
  if (direct.converged && direct.distance <= known && is_minimum(p, direct.x)) return direct.distance;
  // Newton's method went to a saddle or nowhere: slide first.
  const WidePoint x = descend(p, start);
  const Foot foot = foot_of(x);
  const Wide least = std::min<Wide>(known, length(x - p));
  return foot.converged && foot.distance > 0 ? std::min<Wide>(least, foot.distance) : least;
}

double FootPointDistance::from_starts(Vec3 point, std::span<const WidePoint> starts) const {
  const WidePoint p = wide(point);
  std::vector<WidePoint> nearest(starts.begin(), starts.end());
  if (const auto fallen = onto_surface(p)) nearest.push_back(*fallen);
  std::sort(nearest.begin(), nearest.end(), [&p](const WidePoint& a, const WidePoint& b) {
    return inner(a - p, a - p) < inner(b - p, b - p);
  });
  // Few sheets compete, and one that is met three times as far away is hardly nearer elsewhere.
  constexpr std::size_t kStarts = 4;
  constexpr int kFar = 3;
  Wide best = std::numeric_limits<Wide>::infinity();
  for (std::size_t i = 0; i < std::min(kStarts, nearest.size()); ++i) {
    if (length(nearest[i] - p) > kFar * best) break;
    best = std::min<Wide>(best, distance_from(p, nearest[i]));
  }
  // A critical point of f where f is zero is a singular point of the surface.
  const WidePoint critical = critical_point(p);
  const Value there = evaluate(critical);
  if (abs(there.f) <= there.noise) best = std::min<Wide>(best, length(critical - p));
  return static_cast<double>(best);
}

}  // namespace graze::truth
