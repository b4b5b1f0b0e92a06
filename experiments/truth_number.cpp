#include <algorithm>
#include <cmath>
#include <graze/experiments/truth_number.hpp>
#include <limits>

namespace graze::truth {
namespace {

mpz_ptr raw(Integer& a) { return a.backend().data(); }
mpz_srcptr raw(const Integer& a) { return a.backend().data(); }

double without_sign_of_zero(double x) { return x == 0 ? 0 : x; }

Integer power_of_ten(long e) {
  Integer result;
  mpz_ui_pow_ui(raw(result), 10, static_cast<unsigned long>(e));
  return result;
}

/// floor(a 2^e 10^p) and whether nothing was cut off.
std::pair<Integer, bool> scaled_floor(mpfr_srcptr a, long e, long p) {
  Integer m;
  if (mpfr_zero_p(a) != 0) return {m, true};
  e += mpfr_get_z_2exp(raw(m), a);
  Integer divisor = 1;
  if (p >= 0) m *= power_of_ten(p);
  if (p < 0) divisor = power_of_ten(-p);
  if (e >= 0) m = shifted(m, e);
  if (e < 0) divisor = shifted(divisor, -e);
  Integer quotient;
  Integer rest;
  mpz_fdiv_qr(raw(quotient), raw(rest), raw(m), raw(divisor));
  return {quotient, sign(rest) == 0};
}

Rational decimal_value(const Integer& q, long p) {
  return p >= 0 ? Rational(q, power_of_ten(p)) : Rational(q * power_of_ten(-p));
}

/// q 10^-p as text; `trimmed` drops zeros behind the point that an exact number does not need.
std::string to_text(const Integer& q, long p, bool negative, int digits, bool trimmed) {
  // Plain notation for exponents in [-5, 40], as a reader writes them.
  constexpr long kLeastPlain = -5;
  constexpr long kMostPlain = 40;
  std::string s = q.str();
  const long exponent = static_cast<long>(s.size()) - 1 - p;
  while (static_cast<int>(s.size()) > digits && s.back() == '0') s.pop_back();
  while (trimmed && s.size() > 1 && s.back() == '0') s.pop_back();
  std::string text(negative ? 1 : 0, '-');
  if (exponent < kLeastPlain || exponent > kMostPlain) {
    text += s[0];
    if (s.size() > 1) text.append(1, '.').append(s, 1);
    const std::string power = std::to_string(std::labs(exponent));
    text.append(exponent < 0 ? "e-" : "e+").append(power.size() < 2 ? 1 : 0, '0').append(power);
  } else if (exponent < 0) {
    text.append("0.").append(static_cast<std::size_t>(-exponent - 1), '0').append(s);
  } else {
    const auto before_point = static_cast<std::size_t>(exponent) + 1;
    if (s.size() < before_point) s.append(before_point - s.size(), '0');
    text.append(s, 0, before_point);
    if (s.size() > before_point) text.append(1, '.').append(s, before_point);
  }
  return text;
}

/// A number between h and h + 1, or exactly h, half units of its last decimal place: value = h / (2 10^p).
struct HalfUnits {
  Integer h;
  long p = 0;
  bool exact = false;
};

/// Half units of |number| from one enclosure; none if it is too wide to tell.
std::optional<HalfUnits> half_units(const Interval& size, int digits,
                                    const std::function<bool(const Rational&)>& equals) {
  // Estimate of log10, put right below when it is off by one.
  long e = 0;
  const double m = mpfr_get_d_2exp(&e, size.lo(), MPFR_RNDN);
  constexpr double kLog10Of2 = 0.30102999566398119521;
  long p = digits - 1 - static_cast<long>(std::floor(std::log10(m) + static_cast<double>(e) * kLog10Of2));
  const Integer top = 2 * power_of_ten(digits);
  auto [lo, lo_exact] = scaled_floor(size.lo(), 1, p);
  while (lo >= top) std::tie(lo, lo_exact) = scaled_floor(size.lo(), 1, --p);
  while (10 * lo < top) std::tie(lo, lo_exact) = scaled_floor(size.lo(), 1, ++p);
  auto [hi, hi_exact] = scaled_floor(size.hi(), 1, p);
  if (mpfr_equal_p(size.lo(), size.hi()) != 0) return HalfUnits{lo, p, lo_exact};
  const auto is = [&](const Integer& h) { return equals(decimal_value(h, p) / 2); };
  if (lo_exact && is(lo)) return HalfUnits{lo, p, true};
  if (hi == lo) return HalfUnits{lo, p, false};
  if (hi - lo == 1 && is(hi)) return HalfUnits{hi, p, true};
  return std::nullopt;
}

void write_decimals(Real& real, const HalfUnits& value, bool negative, int digits) {
  const bool odd = mpz_odd_p(raw(value.h)) != 0;
  const Integer below = value.h / 2;
  const Integer above = below + 1;
  const auto text = [&](const Integer& q, bool trimmed) {
    return to_text(q, value.p, negative, digits, trimmed);
  };
  if (value.exact && !odd) {
    real.decimal = real.lo = real.hi = text(below, true);
    return;
  }
  // Half way between two decimals the even one is the rounded one.
  const bool up = value.exact ? mpz_odd_p(raw(below)) != 0 : odd;
  real.lo = text(below, false);
  real.hi = text(above, false);
  real.decimal = up ? real.hi : real.lo;
  if (negative) std::swap(real.lo, real.hi);
}

/// The exact point where rounding changes between two neighbouring doubles a < b.
Rational rounding_boundary(double a, double b) {
  const Rational past_largest = rational(std::numeric_limits<double>::max()) +
                                rational(std::numeric_limits<double>::max()) -
                                rational(std::nextafter(std::numeric_limits<double>::max(), 0.0));
  const Rational left = std::isinf(a) ? Rational(-past_largest) : rational(a);
  const Rational right = std::isinf(b) ? past_largest : rational(b);
  return (left + right) / 2;
}

double round_to_double(const Rational& q) {
  // A boundary between doubles has at most 54 bits and their sum with a double fits: exact, then rounded
  // once.
  mpfr_t value;
  mpfr_init2(value, 4096);
  mpfr_set_q(value, q.backend().data(), MPFR_RNDN);
  const double result = mpfr_get_d(value, MPFR_RNDN);
  mpfr_clear(value);
  return result;
}

struct Decimal {
  Integer q;
  long e = 0;
};

Decimal parse(const std::string& text) {
  Decimal result;
  std::string digits;
  const std::size_t mark = text.find('e');
  bool behind = false;
  for (const char c : text.substr(0, mark)) {
    if (c == '.') behind = true;
    if (c == '.') continue;
    digits += c;
    if (behind) --result.e;
  }
  mpz_set_str(raw(result.q), digits.c_str(), 10);
  if (mark != std::string::npos) result.e += std::stol(text.substr(mark + 1));
  return result;
}

/// a < b
bool less(const std::string& a, const std::string& b) {
  Decimal x = parse(a);
  Decimal y = parse(b);
  const long e = std::min(x.e, y.e);
  return x.q * power_of_ten(x.e - e) < y.q * power_of_ten(y.e - e);
}

}  // namespace

Rational rational(double x) {
  const Dyadic d = exact(x);
  return rational(Integer(d.m), -d.e);
}

Rational rational(const Integer& m, long k) {
  return k >= 0 ? Rational(m, shifted(Integer(1), k)) : Rational(shifted(m, -k));
}

Interval Interval::of(const Integer& lo, const Integer& hi, long e, mpfr_prec_t precision) {
  Interval r(precision);
  mpfr_set_z_2exp(r.lo_, raw(lo), e, MPFR_RNDD);
  mpfr_set_z_2exp(r.hi_, raw(hi), e, MPFR_RNDU);
  return r;
}

Interval Interval::of(double value, mpfr_prec_t precision) {
  Interval r(std::max<mpfr_prec_t>(precision, std::numeric_limits<double>::digits));
  mpfr_set_d(r.lo_, value, MPFR_RNDD);
  mpfr_set_d(r.hi_, value, MPFR_RNDU);
  return r;
}

Interval Interval::of(const Rational& value, mpfr_prec_t precision) {
  Interval r(precision);
  mpfr_set_q(r.lo_, value.backend().data(), MPFR_RNDD);
  mpfr_set_q(r.hi_, value.backend().data(), MPFR_RNDU);
  return r;
}

int Interval::sign() const {
  if (mpfr_sgn(lo_) > 0) return 1;
  return mpfr_sgn(hi_) < 0 ? -1 : 0;
}

bool Interval::is_relative(long bits) const {
  if (is_zero() || mpfr_equal_p(lo_, hi_) != 0) return true;
  if (contains_zero()) return false;
  mpfr_t width;
  mpfr_init2(width, 32);
  mpfr_sub(width, hi_, lo_, MPFR_RNDU);
  const long size = std::min(mpfr_get_exp(lo_), mpfr_get_exp(hi_)) - 1;
  const bool narrow = mpfr_get_exp(width) <= size - bits;
  mpfr_clear(width);
  return narrow;
}

bool Interval::is_absolute(long bits) const {
  mpfr_t width;
  mpfr_init2(width, 32);
  mpfr_sub(width, hi_, lo_, MPFR_RNDU);
  const bool narrow = mpfr_zero_p(width) != 0 || mpfr_get_exp(width) <= -bits;
  mpfr_clear(width);
  return narrow;
}

double Interval::middle() const {
  mpfr_t sum;
  mpfr_init2(sum, precision() + 2);
  mpfr_add(sum, lo_, hi_, MPFR_RNDN);
  mpfr_div_2ui(sum, sum, 1, MPFR_RNDN);
  const double result = mpfr_get_d(sum, MPFR_RNDN);
  mpfr_clear(sum);
  return without_sign_of_zero(result);
}

Interval operator+(const Interval& a, const Interval& b) {
  Interval r(std::max(a.precision(), b.precision()));
  mpfr_add(r.lo_, a.lo_, b.lo_, MPFR_RNDD);
  mpfr_add(r.hi_, a.hi_, b.hi_, MPFR_RNDU);
  return r;
}

Interval operator-(const Interval& a, const Interval& b) {
  Interval r(std::max(a.precision(), b.precision()));
  mpfr_sub(r.lo_, a.lo_, b.hi_, MPFR_RNDD);
  mpfr_sub(r.hi_, a.hi_, b.lo_, MPFR_RNDU);
  return r;
}

Interval operator-(const Interval& a) {
  Interval r(a.precision());
  mpfr_neg(r.lo_, a.hi_, MPFR_RNDD);
  mpfr_neg(r.hi_, a.lo_, MPFR_RNDU);
  return r;
}

Interval operator*(const Interval& a, const Interval& b) {
  Interval r(std::max(a.precision(), b.precision()));
  const int s = a.sign();
  const int t = b.sign();
  if (s != 0 && t != 0) {
    // Signs known: each end is one product.
    mpfr_mul(r.lo_, t > 0 ? a.lo_ : a.hi_, s > 0 ? b.lo_ : b.hi_, MPFR_RNDD);
    mpfr_mul(r.hi_, t > 0 ? a.hi_ : a.lo_, s > 0 ? b.hi_ : b.lo_, MPFR_RNDU);
    return r;
  }
  Interval other(r.precision());
  mpfr_mul(r.lo_, a.lo_, b.hi_, MPFR_RNDD);
  mpfr_mul(other.lo_, a.hi_, b.lo_, MPFR_RNDD);
  mpfr_min(r.lo_, r.lo_, other.lo_, MPFR_RNDD);
  mpfr_mul(r.hi_, a.lo_, b.lo_, MPFR_RNDU);
  mpfr_mul(other.hi_, a.hi_, b.hi_, MPFR_RNDU);
  mpfr_max(r.hi_, r.hi_, other.hi_, MPFR_RNDU);
  mpfr_mul(other.lo_, a.lo_, b.lo_, MPFR_RNDD);
  mpfr_min(r.lo_, r.lo_, other.lo_, MPFR_RNDD);
  mpfr_mul(other.lo_, a.hi_, b.hi_, MPFR_RNDD);
  mpfr_min(r.lo_, r.lo_, other.lo_, MPFR_RNDD);
  mpfr_mul(other.hi_, a.lo_, b.hi_, MPFR_RNDU);
  mpfr_max(r.hi_, r.hi_, other.hi_, MPFR_RNDU);
  mpfr_mul(other.hi_, a.hi_, b.lo_, MPFR_RNDU);
  mpfr_max(r.hi_, r.hi_, other.hi_, MPFR_RNDU);
  return r;
}

Interval operator/(const Interval& a, const Interval& b) {
  if (b.sign() < 0) return -a / -b;
  Interval r(std::max(a.precision(), b.precision()));
  mpfr_div(r.lo_, a.lo_, mpfr_sgn(a.lo_) >= 0 ? b.hi_ : b.lo_, MPFR_RNDD);
  mpfr_div(r.hi_, a.hi_, mpfr_sgn(a.hi_) >= 0 ? b.lo_ : b.hi_, MPFR_RNDU);
  return r;
}

Interval square(const Interval& a) {
  Interval r(a.precision());
  const bool lo_is_larger = mpfr_cmpabs(a.lo_, a.hi_) > 0;
  mpfr_sqr(r.hi_, lo_is_larger ? a.lo_ : a.hi_, MPFR_RNDU);
  if (a.contains_zero()) {
    mpfr_set_zero(r.lo_, 1);
  } else {
    mpfr_sqr(r.lo_, lo_is_larger ? a.hi_ : a.lo_, MPFR_RNDD);
  }
  return r;
}

Interval sqrt(const Interval& a) {
  Interval r(a.precision());
  if (mpfr_sgn(a.lo_) > 0) {
    mpfr_sqrt(r.lo_, a.lo_, MPFR_RNDD);
  } else {
    mpfr_set_zero(r.lo_, 1);
  }
  if (mpfr_sgn(a.hi_) > 0) {
    mpfr_sqrt(r.hi_, a.hi_, MPFR_RNDU);
  } else {
    mpfr_set_zero(r.hi_, 1);
  }
  return r;
}

Interval times_power_of_two(Interval a, long e) {
  mpfr_mul_2si(a.lo_, a.lo_, e, MPFR_RNDD);
  mpfr_mul_2si(a.hi_, a.hi_, e, MPFR_RNDU);
  return a;
}

double nearest(Number& number, double offset, long bits) {
  for (;; bits *= 2) {
    const Interval shifted_number =
        offset == 0 ? number.enclosure(bits) : number.enclosure(bits) - Interval::of(offset, bits);
    const double a = mpfr_get_d(shifted_number.lo(), MPFR_RNDN);
    const double b = mpfr_get_d(shifted_number.hi(), MPFR_RNDN);
    if (a == b) return without_sign_of_zero(a);
    // Only a number on the boundary between two roundings can stay undecided for ever.
    if (a <= 0 && b >= 0 && number.equals(rational(offset))) return 0;
    if (std::nextafter(a, b) != b) continue;
    const Rational boundary = rounding_boundary(a, b);
    if (number.equals(boundary + rational(offset))) return round_to_double(boundary);
  }
}

Real to_real(Number& number, int digits) {
  Real real;
  // 128 bits at least: two doubles and a reserve.
  const long first = std::max(working_bits(digits), 128L);
  for (long bits = first;; bits *= 2) {
    const Interval& value = number.enclosure(bits);
    if (value.is_zero() || (value.contains_zero() && number.equals(Rational(0)))) {
      real.decimal = real.lo = real.hi = std::string(1, '0');
      return real;
    }
    if (value.sign() == 0) continue;
    const bool negative = value.sign() < 0;
    const auto equals = [&](const Rational& q) { return number.equals(negative ? Rational(-q) : q); };
    if (const auto units = half_units(negative ? -value : value, digits, equals)) {
      write_decimals(real, *units, negative, digits);
      break;
    }
  }
  real.head = nearest(number, 0, first);
  if (std::isfinite(real.head)) real.tail = nearest(number, real.head, first);
  return real;
}

Interval image(const Root& root, const Polynomial& f, const Integer& lipschitz, mpfr_prec_t precision) {
  const long d = std::max(degree(f), 0L);
  const long k = std::max(root.k, 0L);
  const Integer value = value_at(f, root.m, root.k);
  if (root.exact || d == 0) return Interval::of(value, value, -k * d, precision);
  const Integer radius = shifted(lipschitz, k * (d - 1));
  return Interval::of(value - radius, value + radius, -k * d, precision);
}

Interval nonzero_image(Root& root, const Polynomial& f, const Integer& lipschitz, long bits) {
  // The first look tells how many bits the value needs; the second usually has them.
  for (long k = std::max(root.k, 32L);;) {
    refine(root, k);
    Interval value = image(root, f, lipschitz, bits + 4);
    if (root.exact || value.is_relative(bits)) return value;
    if (value.contains_zero()) {
      k = 2 * std::max(root.k, k);
    } else {
      const long size = std::min(mpfr_get_exp(value.lo()), mpfr_get_exp(value.hi()));
      k = std::max(root.k + 1, bits + graze::truth::bits(lipschitz) - size + 4);
    }
  }
}

Number number_of(Root& root) {
  const auto enclose = [&root](long bits) {
    // Few leading zeros are usual; each doubling adds as many bits as the interval had.
    for (long k = bits;; k += bits) {
      refine(root, k);
      const long e = -root.k;
      if (root.exact) return Interval::of(root.m, root.m, e, bits + 2);
      const long size = std::min(truth::bits(root.m), truth::bits(Integer(root.m + 1)));
      if (size >= bits) return Interval::of(root.m, root.m + 1, e, bits + 2);
      if (size > 0) refine(root, root.k + bits - size + 1);
    }
  };
  const auto equals = [&root](const Rational& q) {
    const Integer n = numerator(q);
    const Integer d = denominator(q);
    if (root.exact) return rational(root.m, root.k) == q;
    const Rational lo = rational(root.m, root.k);
    const Rational hi = rational(root.m + 1, root.k);
    return lo < q && q < hi && vanishes_at(root, {-n, d});
  };
  return {enclose, equals};
}

int compare_decimals(const Real& a, const Real& b) {
  // Both roundings are monotone, so different double-doubles are in the order of their numbers.
  if (a.head != b.head) return a.head < b.head ? -1 : 1;
  if (a.tail != b.tail) return a.tail < b.tail ? -1 : 1;
  if (less(a.hi, b.lo)) return -1;
  return less(b.hi, a.lo) ? 1 : 0;
}

}  // namespace graze::truth
