// SIMD lanes of doubles: the same operations, bit for bit, on every instruction set.
//
// A source that is compiled once for each instruction set includes this header and works in the namespace
// GRAZE_LANES of its compilation, so that nothing compiled for one processor is linked into the code for
// another. Only IEEE operations that round once are here (+ - * / sqrt fma and comparisons): every lane gives
// what a scalar double gives (asserted in tests/solvers/math/lanes_test.cpp).
//
// needs     GCC or clang vector extensions; the instruction set is the one that the compiler was told
// cost      one instruction an operation; fma without hardware support is the C library's, a lane at a time.
//           Floats are twice as many: for filters with bounds of their own, and for guesses. With
//           GRAZE_COUNTED_LANES they are lanes_counting.hpp's, which count instead
#pragma once

#include <cstddef>
#include <cstdint>

#if defined(GRAZE_COUNTED_LANES)
#include <graze/solvers/math/lanes_counting.hpp>
#define GRAZE_LANES counting
#else

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

inline constexpr std::size_t kFloats = std::size_t{2} * kLanes;

/// kLanes doubles. + - * / and comparisons are the compiler's own; `mask ? a : b` selects by lane.
using Lanes = double __attribute__((vector_size(8 * kLanes)));
/// kLanes 64-bit integers; a comparison's mask has all bits of a true lane set.
using Mask = decltype(Lanes{} < Lanes{});
/// kFloats floats, with 32-bit masks.
using Floats = float __attribute__((vector_size(8 * kLanes)));
using FloatMask = decltype(Floats{} < Floats{});

inline Lanes all(double x) { return x - Lanes{}; }
inline Floats all(float x) { return x - Floats{}; }

inline Lanes load(const double* from) {
  Lanes x;
  __builtin_memcpy(&x, from, sizeof x);
  return x;
}
inline void store(double* to, Lanes x) { __builtin_memcpy(to, &x, sizeof x); }
inline Floats load(const float* from) {
  Floats x;
  __builtin_memcpy(&x, from, sizeof x);
  return x;
}
inline void store(float* to, Floats x) { __builtin_memcpy(to, &x, sizeof x); }

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
inline Floats fma(Floats a, Floats b, Floats c) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  return _mm512_fmadd_ps(a, b, c);
#elif defined(__AVX2__) && defined(__FMA__)
  return _mm256_fmadd_ps(a, b, c);
#else
  for (int i = 0; i < 2 * kLanes; ++i) c[i] = __builtin_fmaf(a[i], b[i], c[i]);
  return c;
#endif
}

inline Lanes sqrt(Lanes x) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  return _mm512_sqrt_pd(x);
#elif defined(__AVX2__) && defined(__FMA__)
  return _mm256_sqrt_pd(x);
#elif defined(__SSE2__)
  return _mm_sqrt_pd(x);
#else
  for (int i = 0; i < kLanes; ++i) x[i] = __builtin_sqrt(x[i]);
  return x;
#endif
}
inline Floats sqrt(Floats x) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  return _mm512_sqrt_ps(x);
#elif defined(__AVX2__) && defined(__FMA__)
  return _mm256_sqrt_ps(x);
#elif defined(__SSE2__)
  return _mm_sqrt_ps(x);
#else
  for (int i = 0; i < 2 * kLanes; ++i) x[i] = __builtin_sqrtf(x[i]);
  return x;
#endif
}

/// The lanes of two as floats, rounded.
inline Floats narrow(Lanes first, Lanes second) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  const __m512 low = _mm512_castps256_ps512(_mm512_cvtpd_ps(first));
  return _mm512_insertf32x8(low, _mm512_cvtpd_ps(second), 1);
#elif defined(__AVX2__) && defined(__FMA__)
  return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm256_cvtpd_ps(first)), _mm256_cvtpd_ps(second), 1);
#else
  Floats x;
  for (int i = 0; i < kLanes; ++i) x[i] = static_cast<float>(first[i]);
  for (int i = 0; i < kLanes; ++i) x[kLanes + i] = static_cast<float>(second[i]);
  return x;
#endif
}
struct TwoLanes {
  Lanes first, second;
};
inline TwoLanes widen(Floats x) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  return {_mm512_cvtps_pd(_mm512_castps512_ps256(x)), _mm512_cvtps_pd(_mm512_extractf32x8_ps(x, 1))};
#elif defined(__AVX2__) && defined(__FMA__)
  return {_mm256_cvtps_pd(_mm256_castps256_ps128(x)), _mm256_cvtps_pd(_mm256_extractf128_ps(x, 1))};
#else
  TwoLanes y;
  for (int i = 0; i < kLanes; ++i) y.first[i] = static_cast<double>(x[i]);
  for (int i = 0; i < kLanes; ++i) y.second[i] = static_cast<double>(x[kLanes + i]);
  return y;
#endif
}

inline Mask bits_of(Lanes x) {
  Mask b;
  __builtin_memcpy(&b, &x, sizeof b);
  return b;
}
inline FloatMask bits_of(Floats x) {
  FloatMask b;
  __builtin_memcpy(&b, &x, sizeof b);
  return b;
}
inline Lanes from_bits(Mask b) {
  Lanes x;
  __builtin_memcpy(&x, &b, sizeof x);
  return x;
}
inline Floats from_bits(FloatMask b) {
  Floats x;
  __builtin_memcpy(&x, &b, sizeof x);
  return x;
}

inline Lanes select(Mask mask, Lanes a, Lanes b) { return mask ? a : b; }
inline Floats select(FloatMask mask, Floats a, Floats b) { return mask ? a : b; }
inline Lanes abs(Lanes x) { return from_bits(bits_of(x) & 0x7fff'ffff'ffff'ffff); }
inline Floats abs(Floats x) { return from_bits(bits_of(x) & 0x7fff'ffff); }
/// The larger one; b where one is no number. The instruction says the same.
inline Lanes max(Lanes a, Lanes b) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  return _mm512_max_pd(a, b);
#elif defined(__AVX2__) && defined(__FMA__)
  return _mm256_max_pd(a, b);
#else
  return a > b ? a : b;
#endif
}
inline Floats max(Floats a, Floats b) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  return _mm512_max_ps(a, b);
#elif defined(__AVX2__) && defined(__FMA__)
  return _mm256_max_ps(a, b);
#else
  return a > b ? a : b;
#endif
}
inline Lanes min(Lanes a, Lanes b) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  return _mm512_min_pd(a, b);
#elif defined(__AVX2__) && defined(__FMA__)
  return _mm256_min_pd(a, b);
#else
  return a < b ? a : b;
#endif
}
inline Floats min(Floats a, Floats b) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  return _mm512_min_ps(a, b);
#elif defined(__AVX2__) && defined(__FMA__)
  return _mm256_min_ps(a, b);
#else
  return a < b ? a : b;
#endif
}

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
inline unsigned to_bits(FloatMask mask) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  return _mm512_movepi32_mask(reinterpret_cast<__m512i>(mask));
#elif defined(__AVX2__) && defined(__FMA__)
  return static_cast<unsigned>(_mm256_movemask_ps(from_bits(mask)));
#elif defined(__SSE2__)
  return static_cast<unsigned>(_mm_movemask_ps(from_bits(mask)));
#else
  unsigned bits = 0;
  for (int i = 0; i < 2 * kLanes; ++i) bits |= (mask[i] != 0 ? 1U : 0U) << static_cast<unsigned>(i);
  return bits;
#endif
}

#if defined(__AVX2__) && !defined(__AVX512F__)
/// For four bits: which of eight 32-bit parts of four 64-bit lanes go to the front, in order.
alignas(32) inline constexpr std::int32_t kFront[16][8] = {
    {0, 1, 2, 3, 4, 5, 6, 7}, {0, 1, 2, 3, 4, 5, 6, 7}, {2, 3, 0, 1, 4, 5, 6, 7}, {0, 1, 2, 3, 4, 5, 6, 7},
    {4, 5, 0, 1, 2, 3, 6, 7}, {0, 1, 4, 5, 2, 3, 6, 7}, {2, 3, 4, 5, 0, 1, 6, 7}, {0, 1, 2, 3, 4, 5, 6, 7},
    {6, 7, 0, 1, 2, 3, 4, 5}, {0, 1, 6, 7, 2, 3, 4, 5}, {2, 3, 6, 7, 0, 1, 4, 5}, {0, 1, 2, 3, 6, 7, 4, 5},
    {4, 5, 6, 7, 0, 1, 2, 3}, {0, 1, 4, 5, 6, 7, 2, 3}, {2, 3, 4, 5, 6, 7, 0, 1}, {0, 1, 2, 3, 4, 5, 6, 7}};
/// And back: which of the 32-bit parts at the front go to each of four 64-bit lanes, for the lowest three
/// bits.
alignas(32) inline constexpr std::int32_t kBack[8][8] = {
    {0, 1, 0, 1, 0, 1, 0, 1}, {0, 1, 2, 3, 2, 3, 2, 3}, {0, 1, 0, 1, 2, 3, 2, 3}, {0, 1, 2, 3, 4, 5, 4, 5},
    {0, 1, 0, 1, 0, 1, 2, 3}, {0, 1, 2, 3, 2, 3, 4, 5}, {0, 1, 0, 1, 2, 3, 4, 5}, {0, 1, 2, 3, 4, 5, 6, 7}};
/// kFront of four 32-bit lanes.
alignas(16) inline constexpr std::int32_t kFront4[16][4] = {
    {0, 1, 2, 3}, {0, 1, 2, 3}, {1, 0, 2, 3}, {0, 1, 2, 3}, {2, 0, 1, 3}, {0, 2, 1, 3},
    {1, 2, 0, 3}, {0, 1, 2, 3}, {3, 0, 1, 2}, {0, 3, 1, 2}, {1, 3, 0, 2}, {0, 1, 3, 2},
    {2, 3, 0, 1}, {0, 2, 3, 1}, {1, 2, 3, 0}, {0, 1, 2, 3}};
#endif

/// Writes the lanes whose bits are set to `to`, one after another; memory for kLanes doubles is written.
inline void store_selected(double* to, unsigned bits, Lanes x) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  // Not the zeroing form: it waits for whatever its register held before.
  store(to, _mm512_mask_compress_pd(x, static_cast<__mmask8>(bits), x));
#elif defined(__AVX2__) && defined(__FMA__)
  const __m256i order = _mm256_load_si256(reinterpret_cast<const __m256i*>(kFront[bits]));
  store(to, _mm256_castps_pd(_mm256_permutevar8x32_ps(_mm256_castpd_ps(x), order)));
#else
  int next = 0;
  for (int i = 0; i < kLanes; ++i) {
    to[next] = x[i];
    next += static_cast<int>(bits >> static_cast<unsigned>(i) & 1U);
  }
#endif
}
/// The same for kFloats floats.
inline void store_selected(float* to, unsigned bits, Floats x) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  store(to, _mm512_mask_compress_ps(x, static_cast<__mmask16>(bits), x));
#elif defined(__AVX2__) && defined(__FMA__)
  const auto front = [](__m128 half, unsigned four) {
    return _mm_permutevar_ps(half, _mm_load_si128(reinterpret_cast<const __m128i*>(kFront4[four])));
  };
  const unsigned low = bits & 0xf;
  _mm_storeu_ps(to, front(_mm256_castps256_ps128(x), low));
  _mm_storeu_ps(to + __builtin_popcount(low), front(_mm256_extractf128_ps(x, 1), bits >> 4U));
#else
  int next = 0;
  for (int i = 0; i < 2 * kLanes; ++i) {
    to[next] = x[i];
    next += static_cast<int>(bits >> static_cast<unsigned>(i) & 1U);
  }
#endif
}
/// The same for kFloats numbers first, first + 1, ...
inline void store_selected_numbers(std::int32_t* to, unsigned bits, std::int32_t first) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  const __m512i numbers = _mm512_add_epi32(
      _mm512_set1_epi32(first), _mm512_set_epi32(15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0));
  _mm512_storeu_si512(to, _mm512_mask_compress_epi32(numbers, static_cast<__mmask16>(bits), numbers));
#elif defined(__AVX2__) && defined(__FMA__)
  const __m256i numbers =
      _mm256_add_epi32(_mm256_set1_epi32(first), _mm256_set_epi32(7, 6, 5, 4, 3, 2, 1, 0));
  float packed[8 + 4];
  store_selected(packed, bits, _mm256_castsi256_ps(numbers));
  __builtin_memcpy(to, packed, sizeof numbers);
#else
  int next = 0;
  for (int i = 0; i < 2 * kLanes; ++i) {
    to[next] = first + i;
    next += static_cast<int>(bits >> static_cast<unsigned>(i) & 1U);
  }
#endif
}

/// Reads what store_selected wrote: lanes whose bits are set take the numbers from `from` on, the others are
/// zero; memory of kLanes doubles is read.
inline Lanes load_selected(const double* from, unsigned bits) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  const __m512d x = load(from);
  return _mm512_maskz_mov_pd(static_cast<__mmask8>(bits),
                             _mm512_mask_expand_pd(x, static_cast<__mmask8>(bits), x));
#elif defined(__AVX2__) && defined(__FMA__)
  const __m256i order = _mm256_load_si256(reinterpret_cast<const __m256i*>(kBack[bits & 7]));
  const __m256i one = _mm256_set_epi64x(8, 4, 2, 1);
  const __m256i chosen = _mm256_cmpeq_epi64(_mm256_and_si256(_mm256_set1_epi64x(bits), one), one);
  const __m256 spread = _mm256_permutevar8x32_ps(_mm256_castpd_ps(load(from)), order);
  return _mm256_and_pd(_mm256_castps_pd(spread), _mm256_castsi256_pd(chosen));
#else
  Lanes x{};
  for (int i = 0; i < kLanes; ++i) {
    const bool chosen = (bits >> static_cast<unsigned>(i) & 1U) != 0;
    if (chosen) x[i] = *from++;
  }
  return x;
#endif
}

/// Small whole numbers as bytes.
inline void store_bytes(std::int8_t* to, Lanes x) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  const __m512i wide = _mm512_castsi256_si512(_mm512_cvtpd_epi32(x));
  _mm_storel_epi64(reinterpret_cast<__m128i*>(to), _mm512_cvtepi32_epi8(wide));
#else
  for (int i = 0; i < kLanes; ++i) to[i] = static_cast<std::int8_t>(x[i]);
#endif
}

/// kLanes records of six doubles, wherever they are, as six vectors: to[i][k] = record(k)[i].
template <class Record>
[[gnu::always_inline]] inline void load_records_at(const Record& record, Lanes (&to)[6]) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  // Records (0, 2), (1, 3), (4, 6), (5, 7): unpacked in pairs, the halves come out in order.
  const auto four = [&](std::size_t a, std::size_t b) {
    return _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_loadu_pd(record(a))), _mm256_loadu_pd(record(b)),
                              1);
  };
  const auto two = [&](std::size_t first) {
    __m512d x = _mm512_castpd128_pd512(_mm_loadu_pd(record(first) + 4));
    x = _mm512_insertf64x2(x, _mm_loadu_pd(record(first + 2) + 4), 1);
    x = _mm512_insertf64x2(x, _mm_loadu_pd(record(first + 4) + 4), 2);
    return _mm512_insertf64x2(x, _mm_loadu_pd(record(first + 6) + 4), 3);
  };
  const __m512d a = four(0, 2), b = four(1, 3), c = four(4, 6), d = four(5, 7), e = two(0), f = two(1);
  const __m512d ab = _mm512_unpacklo_pd(a, b), cd = _mm512_unpacklo_pd(c, d);
  const __m512d ab_hi = _mm512_unpackhi_pd(a, b), cd_hi = _mm512_unpackhi_pd(c, d);
  to[0] = _mm512_shuffle_f64x2(ab, cd, 0x88);
  to[1] = _mm512_shuffle_f64x2(ab_hi, cd_hi, 0x88);
  to[2] = _mm512_shuffle_f64x2(ab, cd, 0xdd);
  to[3] = _mm512_shuffle_f64x2(ab_hi, cd_hi, 0xdd);
  to[4] = _mm512_unpacklo_pd(e, f);
  to[5] = _mm512_unpackhi_pd(e, f);
#elif defined(__AVX2__) && defined(__FMA__)
  const __m256d a = _mm256_loadu_pd(record(0)), b = _mm256_loadu_pd(record(1));
  const __m256d c = _mm256_loadu_pd(record(2)), d = _mm256_loadu_pd(record(3));
  const auto two = [&](std::size_t first) {
    return _mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_loadu_pd(record(first) + 4)),
                                _mm_loadu_pd(record(first + 2) + 4), 1);
  };
  const __m256d e = two(0), f = two(1);
  const __m256d ab = _mm256_unpacklo_pd(a, b), cd = _mm256_unpacklo_pd(c, d);
  const __m256d ab_hi = _mm256_unpackhi_pd(a, b), cd_hi = _mm256_unpackhi_pd(c, d);
  to[0] = _mm256_permute2f128_pd(ab, cd, 0x20);
  to[1] = _mm256_permute2f128_pd(ab_hi, cd_hi, 0x20);
  to[2] = _mm256_permute2f128_pd(ab, cd, 0x31);
  to[3] = _mm256_permute2f128_pd(ab_hi, cd_hi, 0x31);
  to[4] = _mm256_unpacklo_pd(e, f);
  to[5] = _mm256_unpackhi_pd(e, f);
#else
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t k = 0; k < kLanes; ++k) to[i][k] = record(k)[i];
  }
#endif
}
}  // namespace graze::GRAZE_LANES

#endif

namespace graze::GRAZE_LANES {

/// 2^-floor(log2 x) for normal x > 0, exactly.
inline Lanes reciprocal_power(Lanes x) {
  constexpr std::int64_t kExponent = 0x7ff0'0000'0000'0000;
  constexpr std::int64_t kTwiceBias = 0x7fe0'0000'0000'0000;  // exponent bits of 2^e and 2^-e add up to it
  return from_bits(kTwiceBias - (bits_of(x) & kExponent));
}

/// As load_records_at, for records that follow one another: to[i][k] = from[6 k + i].
inline void load_records(const double* from, Lanes (&to)[6]) {
  load_records_at([from](std::size_t k) { return from + 6 * k; }, to);
}

/// Calls take(from, at, count) for kGroup records of six doubles at a time, from record `at` on; the last
/// ones, where they are fewer, come padded with zeros.
template <std::size_t kGroup, class Take>
inline void for_groups(const double* records, std::size_t size, const Take& take) {
  std::size_t at = 0;
  for (; at + kGroup <= size; at += kGroup) take(records + 6 * at, at, kGroup);
  if (at == size) return;
  double last[6 * kGroup] = {};
  __builtin_memcpy(last, records + 6 * at, 6 * sizeof(double) * (size - at));
  take(last, at, size - at);
}

}  // namespace graze::GRAZE_LANES
