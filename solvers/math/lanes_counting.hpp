// Lanes that count: what lanes.hpp gives, one ray wide, for the cost of a kernel apart from any machine.
//
// solves    a kernel's lanes source, compiled with GRAZE_COUNTED_LANES, adds what it does to the count of the
//           CountingScope that is open on its thread
// needs     rays one at a time: the second lane of floats has no ray of its own, and costs nothing beside
//           the first; what a source does for it in doubles counts (the teardrop: 7 of a camera ray's
//           312). For the counting component alone (experiments/CMakeLists.txt)
// returns   what every lane of the other instruction sets gives, bit for bit
// error     none: every operation of the lanes that depends on the ray is counted, as counting.hpp says.
//           Operations on constants alone are not, nor changes between double and float, nor what the source
//           does in scalars: once a batch, or comparisons of what is proved
// cost      one increment an operation
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include <graze/solvers/math/counting.hpp>

namespace graze::counting {

inline constexpr int kLanes = 1;
inline constexpr std::size_t kFloats = 2;

/// A comparison's mask has all bits of a true lane set.
using Mask = std::int64_t __attribute__((vector_size(8)));
using FloatMask = std::int32_t __attribute__((vector_size(8)));

/// Numbers side by side, as many as M has lanes, with the operators of a vector; an operation counts once.
template <class T, class M>
class CountedVector {
  static constexpr std::size_t kSize = sizeof(M) / sizeof(T);

 public:
  CountedVector() = default;
  // A constant, so that formulas may write 2 * x.
  CountedVector(T constant) {
    for (T& value : values_) value = constant;
  }
  /// A ray's numbers.
  static CountedVector loaded(const T* from) {
    CountedVector x;
    __builtin_memcpy(x.values_, from, sizeof x.values_);
    x.is_constant_ = false;
    return x;
  }

  /// Whoever writes a lane makes it a ray's.
  T& operator[](std::size_t lane) {
    is_constant_ = false;
    return values_[lane];
  }
  const T& operator[](std::size_t lane) const { return values_[lane]; }
  [[nodiscard]] const T* values() const { return values_; }

  friend CountedVector operator-(const CountedVector& x) {
    return x.each([](T a) { return -a; });
  }
  friend CountedVector operator+(const CountedVector& x, const CountedVector& y) {
    note(&OperationCount::additions, x, y);
    return x.each(y, [](T a, T b) { return a + b; });
  }
  friend CountedVector operator-(const CountedVector& x, const CountedVector& y) {
    note(&OperationCount::additions, x, y);
    return x.each(y, [](T a, T b) { return a - b; });
  }
  friend CountedVector operator*(const CountedVector& x, const CountedVector& y) {
    note(&OperationCount::multiplications, x, y);
    return x.each(y, [](T a, T b) { return a * b; });
  }
  friend CountedVector operator/(const CountedVector& x, const CountedVector& y) {
    note(&OperationCount::divisions, x, y);
    return x.each(y, [](T a, T b) { return a / b; });
  }
  friend CountedVector& operator+=(CountedVector& x, const CountedVector& y) { return x = x + y; }
  friend CountedVector& operator-=(CountedVector& x, const CountedVector& y) { return x = x - y; }
  friend CountedVector& operator*=(CountedVector& x, const CountedVector& y) { return x = x * y; }
  friend CountedVector& operator/=(CountedVector& x, const CountedVector& y) { return x = x / y; }

  friend M operator<(const CountedVector& x, const CountedVector& y) {
    return compared(x, y, [](T a, T b) { return a < b; });
  }
  friend M operator>(const CountedVector& x, const CountedVector& y) { return y < x; }
  friend M operator<=(const CountedVector& x, const CountedVector& y) {
    return compared(x, y, [](T a, T b) { return a <= b; });
  }
  friend M operator>=(const CountedVector& x, const CountedVector& y) { return y <= x; }
  friend M operator==(const CountedVector& x, const CountedVector& y) {
    return compared(x, y, [](T a, T b) { return a == b; });
  }
  friend M operator!=(const CountedVector& x, const CountedVector& y) {
    return compared(x, y, [](T a, T b) { return a != b; });
  }

  friend CountedVector fma(const CountedVector& x, const CountedVector& y, const CountedVector& z) {
    note(&OperationCount::fused, x, y, z);
    CountedVector sum = x.each(y, [](T a, T /*b*/) { return a; });
    sum.is_constant_ = sum.is_constant_ && z.is_constant_;
    for (std::size_t i = 0; i < kSize; ++i) sum.values_[i] = fused(x.values_[i], y.values_[i], z.values_[i]);
    return sum;
  }
  friend CountedVector sqrt(const CountedVector& x) {
    note(&OperationCount::square_roots, x);
    return x.each([](T a) {
      if constexpr (sizeof(T) == 8)
        return __builtin_sqrt(a);
      else
        return __builtin_sqrtf(a);
    });
  }
  friend CountedVector abs(const CountedVector& x) {
    return x.each([](T a) {
      if constexpr (sizeof(T) == 8)
        return __builtin_fabs(a);
      else
        return __builtin_fabsf(a);
    });
  }
  friend CountedVector select(M mask, const CountedVector& x, const CountedVector& y) {
    CountedVector one = x.each(y, [](T a, T /*b*/) { return a; });
    for (std::size_t i = 0; i < kSize; ++i) one.values_[i] = mask[i] != 0 ? x.values_[i] : y.values_[i];
    return one;
  }

 private:
  using Field = std::uint64_t OperationCount::*;

  template <class... Operands>
  static void note(Field field, const Operands&... operands) {
    OperationCount* const count = CountingScope::current();
    if (count != nullptr && !(operands.is_constant_ && ...)) ++(count->*field);
  }
  static double fused(double x, double y, double z) { return __builtin_fma(x, y, z); }
  static float fused(float x, float y, float z) { return __builtin_fmaf(x, y, z); }

  template <class Function>
  CountedVector each(const Function& function) const {
    CountedVector result = *this;
    for (T& value : result.values_) value = function(value);
    return result;
  }
  template <class Function>
  CountedVector each(const CountedVector& other, const Function& function) const {
    CountedVector result;
    result.is_constant_ = is_constant_ && other.is_constant_;
    for (std::size_t i = 0; i < kSize; ++i) result.values_[i] = function(values_[i], other.values_[i]);
    return result;
  }
  template <class Function>
  static M compared(const CountedVector& x, const CountedVector& y, const Function& function) {
    note(&OperationCount::comparisons, x, y);
    std::remove_reference_t<decltype(M{}[0])> bits[kSize];
    for (std::size_t i = 0; i < kSize; ++i) bits[i] = function(x.values_[i], y.values_[i]) ? -1 : 0;
    M mask;
    __builtin_memcpy(&mask, bits, sizeof mask);
    return mask;
  }

  T values_[kSize] = {};
  bool is_constant_ = true;  ///< no ray is in it
};

using Lanes = CountedVector<double, Mask>;
using Floats = CountedVector<float, FloatMask>;

// Friends of the above, by name.
Lanes fma(const Lanes& x, const Lanes& y, const Lanes& z);
Floats fma(const Floats& x, const Floats& y, const Floats& z);
Lanes sqrt(const Lanes& x);
Floats sqrt(const Floats& x);
Lanes abs(const Lanes& x);
Floats abs(const Floats& x);
Lanes select(Mask mask, const Lanes& x, const Lanes& y);
Floats select(FloatMask mask, const Floats& x, const Floats& y);

inline Lanes all(double x) { return {x}; }
inline Floats all(float x) { return {x}; }
inline Lanes load(const double* from) { return Lanes::loaded(from); }
inline Floats load(const float* from) { return Floats::loaded(from); }
inline void store(double* to, const Lanes& x) { __builtin_memcpy(to, x.values(), sizeof *to); }
inline void store(float* to, const Floats& x) { __builtin_memcpy(to, x.values(), kFloats * sizeof *to); }

/// Two lanes of double as floats, rounded; it is no operation.
inline Floats narrow(const Lanes& first, const Lanes& second) {
  const float both[] = {static_cast<float>(first[0]), static_cast<float>(second[0])};
  return load(both);
}
struct TwoLanes {
  Lanes first, second;
};
inline TwoLanes widen(const Floats& x) {
  const double both[] = {static_cast<double>(x[0]), static_cast<double>(x[1])};
  return {load(both), load(both + 1)};
}

inline Mask bits_of(const Lanes& x) {
  Mask b;
  __builtin_memcpy(&b, x.values(), sizeof b);
  return b;
}
inline FloatMask bits_of(const Floats& x) {
  FloatMask b;
  __builtin_memcpy(&b, x.values(), sizeof b);
  return b;
}
inline Lanes from_bits(Mask b) {
  double x;
  __builtin_memcpy(&x, &b, sizeof x);
  return load(&x);
}

/// The larger one; b where a is no number. It costs the comparison.
inline Lanes max(const Lanes& a, const Lanes& b) { return select(a > b, a, b); }
inline Floats max(const Floats& a, const Floats& b) { return select(a > b, a, b); }
inline Lanes min(const Lanes& a, const Lanes& b) { return select(a < b, a, b); }
inline Floats min(const Floats& a, const Floats& b) { return select(a < b, a, b); }

/// One bit a lane, lane 0 lowest.
inline unsigned to_bits(Mask mask) { return mask[0] < 0 ? 1 : 0; }
inline unsigned to_bits(FloatMask mask) { return (mask[0] < 0 ? 1U : 0U) | (mask[1] < 0 ? 2U : 0U); }

/// Writes the lanes whose bits are set to `to`, one after another; memory for all lanes is written.
inline void store_selected(double* to, unsigned /*bits*/, const Lanes& x) { store(to, x); }
inline void store_selected(float* to, unsigned bits, const Floats& x) {
  to[0] = (bits & 1U) != 0 ? x[0] : x[1];
  to[1] = x[1];
}
/// Reads what that wrote; zero in a lane whose bit is not set.
inline Lanes load_selected(const double* from, unsigned bits) { return bits != 0 ? load(from) : Lanes{}; }
inline void store_selected_numbers(std::int32_t* to, unsigned bits, std::int32_t first) {
  to[0] = (bits & 1U) != 0 ? first : first + 1;
  to[1] = first + 1;
}
/// Small whole numbers as bytes.
inline void store_bytes(std::int8_t* to, const Lanes& x) { *to = static_cast<std::int8_t>(x[0]); }

/// Records of six doubles, wherever they are: to[i] = record(0)[i].
template <class Record>
inline void load_records_at(const Record& record, Lanes (&to)[6]) {
  for (std::size_t i = 0; i < 6; ++i) to[i] = load(record(0) + i);
}

}  // namespace graze::counting
