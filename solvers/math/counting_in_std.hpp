// The functions of a counting scalar under the names std::fabs, std::sqrt, ...: solvers name those of the
// number types that C++ has by std::, so that a program may count what their sources do, as they are.
//
// Solves:  a solver's source, included after this header, compiles for T = Counted<double>.
// Needs:   to come before that source: a qualified name is looked up where it is written. Overloads in std
//          for a type of one's own are not the standard's, though every compiler takes them; so this header
//          is for the counting component alone, and no library includes it.
// Returns, error, cost: those of counting.hpp.
#pragma once

#include <cmath>
#include <complex>
#include <numbers>

#include <graze/solvers/math/counting.hpp>

namespace std {  // NOLINT(cert-dcl58-cpp): see above

// Each calls the hidden friend of Counted, which its argument finds and which a template never hides.
template <class T>
graze::Counted<T> fabs(const graze::Counted<T>& x) {
  return fabs(x);
}
template <class T>
graze::Counted<T> abs(const graze::Counted<T>& x) {
  return abs(x);
}
template <class T>
graze::Counted<T> sqrt(const graze::Counted<T>& x) {
  return sqrt(x);
}
template <class T>
graze::Counted<T> log2(const graze::Counted<T>& x) {
  return log2(x);
}
template <class T>
graze::Counted<T> exp2(const graze::Counted<T>& x) {
  return exp2(x);
}
template <class T>
graze::Counted<T> sin(const graze::Counted<T>& x) {
  return sin(x);
}
template <class T>
graze::Counted<T> cos(const graze::Counted<T>& x) {
  return cos(x);
}
template <class T>
graze::Counted<T> cbrt(const graze::Counted<T>& x) {
  return cbrt(x);
}
template <class T>
graze::Counted<T> ceil(const graze::Counted<T>& x) {
  return ceil(x);
}
template <class T>
bool isfinite(const graze::Counted<T>& x) {
  return isfinite(x);
}
template <class T>
bool isnan(const graze::Counted<T>& x) {
  return isnan(x);
}
template <class T>
long lround(const graze::Counted<T>& x) {
  return lround(x);
}
template <class T>
int ilogb(const graze::Counted<T>& x) {
  return ilogb(x);
}
template <class T>
graze::Counted<T> ldexp(const graze::Counted<T>& x, int k) {
  return ldexp(x, k);
}
template <class T>
graze::Counted<T> copysign(const graze::Counted<T>& x, const graze::Counted<T>& y) {
  return copysign(x, y);
}
template <class T>
graze::Counted<T> nextafter(const graze::Counted<T>& x, const graze::Counted<T>& y) {
  return nextafter(x, y);
}
template <class T>
graze::Counted<T> pow(const graze::Counted<T>& x, const graze::Counted<T>& y) {
  return pow(x, y);
}
template <class T>
graze::Counted<T> fma(const graze::Counted<T>& x, const graze::Counted<T>& y, const graze::Counted<T>& z) {
  return fma(x, y, z);
}

/// The square root that complex<T> has, bit for bit.
template <class T>
complex<graze::Counted<T>> sqrt(const complex<graze::Counted<T>>& z) {
  const complex<T> root = sqrt(complex<T>{z.real().value(), z.imag().value()});
  graze::OperationCount* const count = graze::Counted<T>::note_function(z.real(), z.imag());
  return {graze::Counted<T>(root.real(), count), graze::Counted<T>(root.imag(), count)};
}

/// A constant, as the standard lets a type of one's own have it.
template <class T>
inline constexpr graze::Counted<T> numbers::pi_v<graze::Counted<T>> = numbers::pi_v<T>;

}  // namespace std
