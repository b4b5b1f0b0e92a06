// Directions of reflected and refracted light, and the two highlight terms built on them.
//
// Solves:  R = 2 (N,L) N - L; T = -eta L + (eta (N,L) - sqrt(1 + eta^2 ((N,L)^2 - 1))) N;
//          H = (L + E)/|L + E|; max(0, (R,E))^n (Phong), max(0, (H,N))^n (Blinn).
// Needs:   unit vectors. L points to the light (for a ray: L = -d/|d|), E to the eye, N to the side L is
//          on; from inside a body the caller passes -N and 1/eta: facing_normal() turns N.
// Units:   eta = eta_1/eta_2, the index on L's side over the one beyond: 1/1.52 from air into glass.
// Returns: unit vectors; nothing for total internal reflection, or where there is no half vector.
// Error:   u = 2^-53. For inputs as `normalized` gives them: R, T and H are unit within kUnitError (T:
//          times max(1, eta)); sin T = eta sin L within 8 u max(1, eta), at any angle from normal to
//          grazing. optics.md says what the critical angle does.
// Cost:    R 17, T about 40 operations, no allocation.
// Source:  document 001 (Snell's law in vector form). Changed: the square root is written with sin = |N x
//          L|, so that neither normal incidence nor the critical angle loses digits to 1 - cos^2.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include <graze/surfaces/ray.hpp>

namespace graze {

/// Distance from length 1 of the vectors returned here, for inputs within 3 u of length 1.
inline constexpr double kUnitError = 16 * 0x1p-53;

namespace detail {

/// a b - c d within 1.5 ulp of itself (Jeannerod, Louvet, Muller, Math. Comp. 82, 2013: Kahan's method).
inline double difference_of_products(double a, double b, double c, double d) {
  const double cd = c * d;
  const double error = std::fma(-c, d, cd);
  return std::fma(a, b, -cd) + error;
}

/// a x b, every coordinate with a small relative error: parallel vectors keep their sine.
inline Vec3 accurate_cross(Vec3 a, Vec3 b) {
  return {difference_of_products(a.y, b.z, a.z, b.y), difference_of_products(a.z, b.x, a.x, b.z),
          difference_of_products(a.x, b.y, a.y, b.x)};
}

}  // namespace detail

/// n or -n, whichever points to the side of l; n itself for a grazing l. Where the answer is -n for an
/// outward n, light comes from inside, and refract() takes 1/eta too.
inline Vec3 facing_normal(Vec3 n, Vec3 l) { return dot(n, l) < 0 ? -n : n; }

/// The mirror image of l about n. reflect(reflect(l, n), n) is l.
inline Vec3 reflect(Vec3 l, Vec3 n) { return (2 * dot(n, l)) * n - l; }

/// The direction in which light (or a ray) from l goes on beyond the surface; none if eta sin > 1: total
/// internal reflection. That decision is exact unless |eta sin - 1| < 8 u.
inline std::optional<Vec3> refract(Vec3 l, Vec3 n, double eta) {
  const Vec3 sine = detail::accurate_cross(n, l);
  const double s = eta * norm(sine);
  if (s > 1) return std::nullopt;
  // cos^2 = 1 - s^2 in factors: 1 - s is exact where it matters, near the critical angle.
  const double cosine = std::sqrt((1 - s) * (1 + s));
  // N x (N x L) = (N,L) N - L for a unit N: the tangential part without the document's cancellation.
  return eta * cross(n, sine) - cosine * n;
}

/// The direction halfway between l and e; none if they are exactly opposite. Its angle error is about
/// u / |l + e|: nearly opposite vectors have no well-determined middle.
inline std::optional<Vec3> half_vector(Vec3 l, Vec3 e) {
  const Vec3 sum = l + e;
  if (sum == Vec3{}) return std::nullopt;
  return normalized(sum);
}

namespace detail {

/// max(0, cosine)^shininess; a cosine that rounding put above 1 counts as 1, so that no term exceeds 1.
inline double highlight(double cosine, double shininess) {
  return std::pow(std::clamp(cosine, 0.0, 1.0), shininess);
}

}  // namespace detail

/// Phong's highlight, in [0, 1]; shininess > 0. Relative error about (2 + 3 shininess / (R,E)) u.
inline double phong_term(Vec3 r, Vec3 e, double shininess) { return detail::highlight(dot(r, e), shininess); }

/// Blinn's highlight, in [0, 1]; for a highlight as wide as Phong's, four times his shininess (optics.md).
/// Relative error as Phong's.
inline double blinn_term(Vec3 h, Vec3 n, double shininess) { return detail::highlight(dot(h, n), shininess); }

}  // namespace graze
