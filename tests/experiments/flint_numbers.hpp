// FLINT's rationals and polynomials and Arb's balls as values with operators, for the second engines that
// check certified truth.
#pragma once

#include <arb.h>
#include <flint/fmpq.h>
#include <flint/fmpq_poly.h>

#include <array>
#include <cmath>
#include <graze/surfaces/ray.hpp>
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
  Q(const Q& other) : Q() { fmpq_set(q_, other.q_); }
  Q& operator=(const Q& other) {
    fmpq_set(q_, other.q_);
    return *this;
  }
  ~Q() { fmpq_clear(q_); }
  [[nodiscard]] const fmpq* get() const { return q_; }
  [[nodiscard]] int sign() const { return fmpq_sgn(q_); }
  friend Q operator+(const Q& a, const Q& b) { return with(fmpq_add, a, b); }
  friend Q operator-(const Q& a, const Q& b) { return with(fmpq_sub, a, b); }
  friend Q operator*(const Q& a, const Q& b) { return with(fmpq_mul, a, b); }
  friend Q operator/(const Q& a, const Q& b) { return with(fmpq_div, a, b); }

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
