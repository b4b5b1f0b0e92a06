// FLINT's rationals and polynomials and Arb's balls as values with operators, for the second engines that
// check certified truth.
#pragma once

#include <arb.h>
#include <arb_fmpz_poly.h>
#include <flint/fmpq.h>
#include <flint/fmpq_poly.h>
#include <flint/fmpz_poly.h>
#include <flint/fmpz_poly_factor.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <graze/experiments/truth.hpp>
#include <graze/surfaces/ray.hpp>
#include <string>
#include <utility>

namespace graze::flint {

// Enough bits to call two numbers equal here that agree to all of them: the rays' numbers have far fewer.
constexpr slong kBits = 3000;

class Q {
 public:
  Q() { fmpq_init(q_); }
  Q(double x) : Q() {  // NOLINT(google-explicit-constructor): doubles are numbers here
    int e = 0;
    const double m = std::ldexp(std::frexp(x, &e), 53);
    fmpz_set_d(fmpq_numref(q_), m);
    fmpz_one(fmpq_denref(q_));
    if (e >= 53) fmpq_mul_2exp(q_, q_, static_cast<ulong>(e - 53));
    if (e < 53) fmpq_div_2exp(q_, q_, static_cast<ulong>(53 - e));
  }
  /// A decimal as truth prints it: digits, a point, an exponent.
  explicit Q(const std::string& text) : Q() {
    const std::size_t mark = text.find('e');
    std::string digits = text.substr(0, mark);
    long e = mark == std::string::npos ? 0 : std::stol(text.substr(mark + 1));
    if (const std::size_t point = digits.find('.'); point != std::string::npos) {
      e -= static_cast<long>(digits.size() - point - 1);
      digits.erase(point, 1);
    }
    fmpz_set_str(fmpq_numref(q_), digits.c_str(), 10);
    fmpq_canonicalise(q_);
    Q ten(10);
    fmpq_pow_si(ten.q_, ten.q_, e);
    fmpq_mul(q_, q_, ten.q_);
  }
  Q(const Q& other) : Q() { fmpq_set(q_, other.q_); }
  Q& operator=(const Q& other) {
    fmpq_set(q_, other.q_);
    return *this;
  }
  ~Q() { fmpq_clear(q_); }
  [[nodiscard]] const fmpq* get() const { return q_; }
  [[nodiscard]] int sign() const { return fmpq_sgn(q_); }
  [[nodiscard]] double value() const { return fmpq_get_d(q_); }
  friend Q operator+(const Q& a, const Q& b) { return with(fmpq_add, a, b); }
  friend Q operator-(const Q& a, const Q& b) { return with(fmpq_sub, a, b); }
  friend Q operator*(const Q& a, const Q& b) { return with(fmpq_mul, a, b); }
  friend Q operator/(const Q& a, const Q& b) { return with(fmpq_div, a, b); }
  friend bool operator<(const Q& a, const Q& b) { return fmpq_cmp(a.q_, b.q_) < 0; }
  friend bool operator<=(const Q& a, const Q& b) { return fmpq_cmp(a.q_, b.q_) <= 0; }
  friend bool operator==(const Q& a, const Q& b) { return fmpq_equal(a.q_, b.q_) != 0; }

 private:
  static Q with(void (*f)(fmpq_t, const fmpq_t, const fmpq_t), const Q& a, const Q& b) {
    Q r;
    f(r.q_, a.q_, b.q_);
    return r;
  }
  fmpq_t q_;
};

class QPoly {
 public:
  QPoly() { fmpq_poly_init(p_); }
  explicit QPoly(const Q& c) : QPoly() { fmpq_poly_set_fmpq(p_, c.get()); }
  QPoly(const QPoly& other) : QPoly() { fmpq_poly_set(p_, other.p_); }
  QPoly& operator=(const QPoly& other) {
    fmpq_poly_set(p_, other.p_);
    return *this;
  }
  ~QPoly() { fmpq_poly_clear(p_); }
  [[nodiscard]] const fmpq_poly_struct* get() const { return p_; }
  [[nodiscard]] fmpq_poly_struct* get() { return p_; }
  [[nodiscard]] bool is_zero() const { return fmpq_poly_is_zero(p_) != 0; }
  friend QPoly operator+(const QPoly& a, const QPoly& b) {
    QPoly r;
    fmpq_poly_add(r.p_, a.p_, b.p_);
    return r;
  }
  friend QPoly operator-(const QPoly& a, const QPoly& b) {
    QPoly r;
    fmpq_poly_sub(r.p_, a.p_, b.p_);
    return r;
  }
  friend QPoly operator*(const QPoly& a, const QPoly& b) {
    QPoly r;
    fmpq_poly_mul(r.p_, a.p_, b.p_);
    return r;
  }
  friend QPoly operator*(const Q& a, const QPoly& b) { return QPoly(a) * b; }

 private:
  fmpq_poly_t p_;
};

class Arb {
 public:
  Arb() { arb_init(x_); }
  Arb(const Arb& other) : Arb() { arb_set(x_, other.x_); }
  Arb& operator=(const Arb& other) {
    arb_set(x_, other.x_);
    return *this;
  }
  explicit Arb(const Q& q) : Arb() { arb_set_fmpq(x_, q.get(), kBits); }
  ~Arb() { arb_clear(x_); }
  [[nodiscard]] arb_ptr get() { return x_; }
  [[nodiscard]] arb_srcptr get() const { return x_; }
  [[nodiscard]] int sign() const {
    return arb_is_positive(x_) != 0 ? 1 : (arb_is_negative(x_) != 0 ? -1 : 0);
  }
  [[nodiscard]] double value() const { return arf_get_d(arb_midref(x_), ARF_RND_NEAR); }
  friend Arb operator+(const Arb& a, const Arb& b) { return with(arb_add, a, b); }
  friend Arb operator-(const Arb& a, const Arb& b) { return with(arb_sub, a, b); }
  friend Arb operator*(const Arb& a, const Arb& b) { return with(arb_mul, a, b); }
  friend Arb operator/(const Arb& a, const Arb& b) { return with(arb_div, a, b); }
  friend Arb sqrt(const Arb& a) {
    Arb r;
    arb_sqrt(r.x_, a.x_, kBits);
    return r;
  }

 private:
  static Arb with(void (*f)(arb_t, const arb_t, const arb_t, slong), const Arb& a, const Arb& b) {
    Arb r;
    f(r.x_, a.x_, b.x_, kBits);
    return r;
  }
  arb_t x_;
};

/// Calls visit(factor, exponent, root) for every real root of every irreducible factor of p.
template <class Visit>
void for_each_real_root(const QPoly& p, const Visit& visit) {
  fmpz_poly_t z;
  fmpz_poly_init(z);
  fmpq_poly_get_numerator(z, p.get());
  fmpz_poly_factor_t factors;
  fmpz_poly_factor_init(factors);
  fmpz_poly_factor(factors, z);
  for (slong i = 0; i < factors->num; ++i) {
    const slong n = fmpz_poly_degree(factors->p + i);
    if (n < 1) continue;
    acb_ptr roots = _acb_vec_init(n);
    arb_fmpz_poly_complex_roots(roots, factors->p + i, 0, kBits);
    for (slong j = 0; j < n; ++j) {
      if (arb_is_zero(acb_imagref(roots + j)) != 0)
        visit(factors->p + i, static_cast<unsigned>(factors->exp[i]), acb_realref(roots + j));
    }
    _acb_vec_clear(roots, n);
  }
  fmpz_poly_factor_clear(factors);
  fmpz_poly_clear(z);
}

/// Truth's 40 digits, enclosure and doubles of a number against the number itself.
inline void check_real(const truth::Real& given, const Arb& l) {
  // |decimal - l| <= 5 10^-40 l: half a unit of 40 digits.
  Arb decimal, lo, hi, bound;
  arb_set_str(decimal.get(), given.decimal.c_str(), kBits);
  arb_set_str(lo.get(), given.lo.c_str(), kBits);
  arb_set_str(hi.get(), given.hi.c_str(), kBits);
  arb_set_str(bound.get(), "5e-40", kBits);
  Arb error = decimal - l;
  arb_abs(error.get(), error.get());
  ASSERT_EQ(arb_gt(error.get(), (bound * l).get()), 0) << given.decimal;
  ASSERT_EQ(arb_gt(lo.get(), l.get()), 0) << given.lo;
  ASSERT_EQ(arb_lt(hi.get(), l.get()), 0) << given.hi;
  ASSERT_EQ(given.head, l.value());
  if (!std::isfinite(given.head)) return;
  ASSERT_DOUBLE_EQ(given.tail, (l - Arb(Q(given.head))).value());
}

using Triple = std::array<Q, 3>;
using Rows = std::array<Triple, 3>;

inline Triple triple(Vec3 v) { return {Q(v.x), Q(v.y), Q(v.z)}; }

/// Gauss-Jordan.
inline Rows inverse(Rows a) {
  Rows b{triple({1, 0, 0}), triple({0, 1, 0}), triple({0, 0, 1})};
  for (std::size_t k = 0; k < 3; ++k) {
    std::size_t pivot = k;
    while (a[pivot][k].sign() == 0) ++pivot;
    std::swap(a[k], a[pivot]);
    std::swap(b[k], b[pivot]);
    const Q top = a[k][k];
    for (std::size_t j = 0; j < 3; ++j) {
      a[k][j] = a[k][j] / top;
      b[k][j] = b[k][j] / top;
    }
    for (std::size_t i = 0; i < 3; ++i) {
      if (i == k) continue;
      const Q f = a[i][k];
      for (std::size_t j = 0; j < 3; ++j) {
        a[i][j] = a[i][j] - f * a[k][j];
        b[i][j] = b[i][j] - f * b[k][j];
      }
    }
  }
  return b;
}

inline Triple times(const Rows& m, const Triple& v) {
  Triple r;
  for (std::size_t i = 0; i < 3; ++i) r[i] = m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
  return r;
}

}  // namespace graze::flint
