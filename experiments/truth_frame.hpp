// What every truth needs besides polynomials and numbers: exact vectors, placements, the ray in object space,
// and the fields of a hit that follow from l and a normal.
#pragma once

#include <array>
#include <functional>
#include <graze/experiments/truth.hpp>
#include <graze/experiments/truth_number.hpp>
#include <limits>
#include <optional>

namespace graze::truth {

using Vector = std::array<Integer, 3>;
using Matrix = std::array<Vector, 3>;  ///< rows
using Intervals = std::array<Interval, 3>;

Integer inner(const Vector& a, const Vector& b);
Vector apply(const Matrix& m, const Vector& v);
bool is_zero(const Vector& v);

/// Doubles brought to integers: x_i = integer_i 2^e with one e, the largest for which all are integers.
/// First every double is shown to `see`, then `operator()` gives its integer.
class CommonExponent {
 public:
  void see(double x);
  void see(Vec3 v);
  /// 0 when all were zero.
  [[nodiscard]] long e() const { return e_; }
  [[nodiscard]] Integer operator()(double x) const;
  [[nodiscard]] Vector operator()(Vec3 v) const { return {(*this)(v.x), (*this)(v.y), (*this)(v.z)}; }

 private:
  bool seen_ = false;
  long e_ = 0;
};

/// Object to world: x = M X + T. M = integer matrix 2^e; `adjugate` carries the sign of det, so that
/// M^-1 = adjugate / (det 2^e) with det > 0.
struct Transform {
  Vec3 translate;
  Matrix adjugate;
  Integer det;
  long e = 0;
  bool identity = true;  ///< M = 1: adjugate = 1, det = 1, e = 0
};

/// Throws std::invalid_argument when the placement is not finite or M is singular.
Transform prepare(const Placement& placement);

/// A ray in the object space stretched by det 2^e of the transform, which makes all numbers integers:
/// det 2^e X = o 2^o_e + l d 2^d_e. d is not zero; o_e means nothing where o is zero.
struct ObjectRay {
  Vector o, d;
  long o_e = 0, d_e = 0;
};

/// The ray must be valid.
ObjectRay to_object(const Transform& transform, const Ray& ray);

/// The answer `invalid` with its reason for a ray that is no question, else none.
std::optional<Answer> refusal(const Ray& ray);
/// The answer `coincident`, without hits.
Answer coincident_answer();
/// l as a number that is exactly this rational.
Number rational_length(const Rational& l);
/// o + l d, the nearest double; a zero is decided exactly.
double coordinate(double o, double d, Number& l);
/// The three coordinates of the ray at l.
Vec3 point_at(const Ray& ray, Number& l);

/// M^-T n, of any length.
Intervals to_world(const Transform& transform, const Intervals& n, long bits);
Interval squared_length(const Intervals& v);

/// Encloses a world normal of any length but zero, ever narrower as the number of bits grows.
using NormalAt = std::function<Intervals(long)>;

/// Fills hit.normal (each component to 2^-60) and hit.cosine = |n . d| / |d| (60 bits of itself).
/// `perpendicular`: n . d = 0 is proved, the cosine stays 0. A cosine that still may be zero at `most_bits`
/// counts as zero; without a limit n . d != 0 must be known.
void set_normal(Hit& hit, Vec3 d, const NormalAt& normal, bool perpendicular,
                long most_bits = std::numeric_limits<long>::max());

}  // namespace graze::truth
