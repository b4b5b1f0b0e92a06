// SIMD lanes of doubles: the same operations, bit for bit, on every instruction set.
//
// A source that is compiled once for each instruction set includes this header and works in the namespace
// GRAZE_LANES of its compilation, so that nothing compiled for one processor is linked into the code for
// another. Only IEEE operations that round once are here (+ - * / sqrt fma and comparisons): every lane gives
// what a scalar double gives (asserted in tests/solvers/math/lanes_test.cpp).
//
// needs     GCC or clang vector extensions; the instruction set is the one that the compiler was told
// cost      one instruction an operation; fma without hardware support is the C library's, a lane at a time
#pragma once

#include <cstddef>
#include <cstdint>

#if defined(__AVX512F__) && defined(__AVX512DQ__)
#define GRAZE_LANES avx512
#elif defined(__AVX2__) && defined(__FMA__)
#define GRAZE_LANES avx2
#else
#define GRAZE_LANES baseline
#endif

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace graze::GRAZE_LANES {

#if defined(__AVX512F__) && defined(__AVX512DQ__)
inline constexpr int kLanes = 8;
#elif defined(__AVX2__) && defined(__FMA__)
inline constexpr int kLanes = 4;
#else
inline constexpr int kLanes = 2;
#endif

/// kLanes doubles. + - * / and comparisons are the compiler's own; `mask ? a : b` selects by lane.
using Lanes = double __attribute__((vector_size(8 * kLanes)));
/// kLanes 64-bit integers; a comparison's mask has all bits of a true lane set.
using Mask = decltype(Lanes{} < Lanes{});

inline Lanes all(double x) { return x - Lanes{}; }

inline Lanes load(const double* from) {
  Lanes x;
  __builtin_memcpy(&x, from, sizeof x);
  return x;
}
inline void store(double* to, Lanes x) { __builtin_memcpy(to, &x, sizeof x); }

/// a * b + c, rounded once.
inline Lanes fma(Lanes a, Lanes b, Lanes c) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  return _mm512_fmadd_pd(a, b, c);
#elif defined(__AVX2__) && defined(__FMA__)
  return _mm256_fmadd_pd(a, b, c);
#else
  for (int i = 0; i < kLanes; ++i) c[i] = __builtin_fma(a[i], b[i], c[i]);
  return c;
#endif
}

inline Lanes sqrt(Lanes x) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  return _mm512_maskz_sqrt_pd(0xff, x);  // GCC 12 warns about the unmasked one's own header
#elif defined(__AVX2__) && defined(__FMA__)
  return _mm256_sqrt_pd(x);
#elif defined(__SSE2__)
  return _mm_sqrt_pd(x);
#else
  for (int i = 0; i < kLanes; ++i) x[i] = __builtin_sqrt(x[i]);
  return x;
#endif
}

inline Mask bits_of(Lanes x) {
  Mask b;
  __builtin_memcpy(&b, &x, sizeof b);
  return b;
}
inline Lanes from_bits(Mask b) {
  Lanes x;
  __builtin_memcpy(&x, &b, sizeof x);
  return x;
}

inline Lanes select(Mask mask, Lanes a, Lanes b) { return mask ? a : b; }
inline Lanes abs(Lanes x) { return from_bits(bits_of(x) & 0x7fff'ffff'ffff'ffff); }
/// The larger one; b where a is no number.
inline Lanes max(Lanes a, Lanes b) { return a > b ? a : b; }
inline Lanes min(Lanes a, Lanes b) { return a < b ? a : b; }

/// One bit a lane, lane 0 lowest.
inline unsigned to_bits(Mask mask) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  return _mm512_movepi64_mask(reinterpret_cast<__m512i>(mask));
#elif defined(__AVX2__) && defined(__FMA__)
  return static_cast<unsigned>(_mm256_movemask_pd(from_bits(mask)));
#elif defined(__SSE2__)
  return static_cast<unsigned>(_mm_movemask_pd(from_bits(mask)));
#else
  unsigned bits = 0;
  for (int i = 0; i < kLanes; ++i) bits |= (mask[i] != 0 ? 1U : 0U) << static_cast<unsigned>(i);
  return bits;
#endif
}

/// 2^-floor(log2 x) for normal x > 0, exactly.
inline Lanes reciprocal_power(Lanes x) {
  constexpr std::int64_t kExponent = 0x7ff0'0000'0000'0000;
  constexpr std::int64_t kTwiceBias = 0x7fe0'0000'0000'0000;  // exponent bits of 2^e and 2^-e add up to it
  return from_bits(kTwiceBias - (bits_of(x) & kExponent));
}

/// Writes the lanes whose bits are set to `to`, one after another; memory for kLanes doubles is written.
inline void store_selected(double* to, unsigned bits, Lanes x) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  store(to, _mm512_maskz_compress_pd(static_cast<__mmask8>(bits), x));
#else
  int next = 0;
  for (int i = 0; i < kLanes; ++i) {
    to[next] = x[i];
    next += static_cast<int>(bits >> static_cast<unsigned>(i) & 1U);
  }
#endif
}

/// from[0], from[stride], from[2 stride], ...
inline Lanes load_strided(const double* from, std::size_t stride) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  return Lanes{from[0],          from[stride],     from[2 * stride], from[3 * stride],
               from[4 * stride], from[5 * stride], from[6 * stride], from[7 * stride]};
#elif defined(__AVX2__) && defined(__FMA__)
  return Lanes{from[0], from[stride], from[2 * stride], from[3 * stride]};
#else
  return Lanes{from[0], from[stride]};
#endif
}

}  // namespace graze::GRAZE_LANES
