#include <graze/surfaces/teardrop_exact.hpp>

#include <algorithm>
#include <array>
#include <utility>

namespace graze {
namespace {

ExactPolynomial constant(BigInteger x) { return ExactPolynomial(std::vector<BigInteger>{std::move(x)}); }

/// The polynomials of one line, all times one power of two: integers.
struct Line {
  ExactPolynomial y, to_top;  ///< y and H - y
  ExactPolynomial side;       ///< B
  ExactPolynomial sextic;

  Line(const Ray& ray, double s);
};

/// A common power of two that makes all numbers integers: the equation is homogeneous in lengths, and l is
/// their quotient by d.
long common_exponent(const std::array<Dyadic, 7>& numbers) {
  long least = 0;
  for (const Dyadic& x : numbers) {
    if (!x.is_zero()) least = std::min(least, x.exponent());
  }
  return least;
}

BigInteger in_units_of(const Dyadic& x, long exponent) { return x.floor_in_units_of(exponent); }

Line::Line(const Ray& ray, double s) {
  const std::array<Dyadic, 7> numbers{Dyadic(ray.o.x), Dyadic(ray.o.y), Dyadic(ray.o.z), Dyadic(ray.d.x),
                                      Dyadic(ray.d.y), Dyadic(ray.d.z), Dyadic(s)};
  const long unit = common_exponent(numbers);
  const auto coordinate = [&](std::size_t i) {
    return ExactPolynomial(
        std::vector<BigInteger>{in_units_of(numbers[i], unit), in_units_of(numbers[i + 3], unit)});
  };
  const BigInteger height = in_units_of(numbers[6], unit) * BigInteger(6);
  const BigInteger four_heights = height * BigInteger(4);
  const ExactPolynomial x = coordinate(0), z = coordinate(2);
  y = coordinate(1);
  to_top = constant(height) - y;
  const ExactPolynomial far = constant(height * BigInteger(2)) - y;
  side = x * x * four_heights + z * z * four_heights - y * (far * far + y * height);
  sextic = side * side - y * y * y * far * far * four_heights;
}

/// Whether the line passes inside the body at the pole that the root is, and does not only touch it.
bool passes_inside(const Ray& ray, bool at_apex) {
  const Dyadic x(ray.d.x), y(ray.d.y), z(ray.d.z);
  // The bottom is flat; the apex is a cone of slope R' = -3/4.
  if (!at_apex) return !y.is_zero();
  return Dyadic(16.0) * (sqr(x) + sqr(z)) < Dyadic(9.0) * sqr(y);
}

}  // namespace

std::vector<ExactHit> exact_teardrop_hits(const Ray& ray, double s) {
  const Line line(ray, s);
  std::vector<ExactHit> hits;
  for (const RealRoot& root : isolate_roots(line.sextic, {.lo = Dyadic(0.0), .hi = {}})) {
    if (root.is_exact() && root.lo().is_zero()) continue;
    const int above_bottom = sign_at(line.y, root), below_top = sign_at(line.to_top, root);
    if (above_bottom < 0 || below_top < 0 || sign_at(line.side, root) > 0) continue;
    // A pole is a double root of the sextic: at the bottom since it is squared, at the apex by the cone.
    const bool is_pole = above_bottom == 0 || below_top == 0;
    const bool touches = is_pole ? !passes_inside(ray, below_top == 0) : root.multiplicity() > 1;
    hits.push_back({root, touches ? 2U : 1U});
  }
  return hits;
}

int side_of_teardrop(const Ray& ray, double s, double l) {
  const Dyadic at(l), height = Dyadic(s) * Dyadic(6.0);
  const auto coordinate = [&](double o, double d) { return Dyadic(o) + at * Dyadic(d); };
  const Dyadic y = coordinate(ray.o.y, ray.d.y), to_top = height - y;
  if (y.sign() < 0 || to_top.sign() < 0) return -1;
  const Dyadic w = sqr(coordinate(ray.o.x, ray.d.x)) + sqr(coordinate(ray.o.z, ray.d.z));
  const Dyadic far2 = sqr(height + to_top);
  const Dyadic side = Dyadic(4.0) * height * w - y * (far2 + height * y);
  const int sextic = (sqr(side) - Dyadic(4.0) * height * sqr(y) * y * far2).sign();
  return side.sign() > 0 ? -1 : sextic;
}

}  // namespace graze
