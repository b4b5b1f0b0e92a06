#include <graze/solvers/math/big_integer.hpp>

#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

namespace graze {
namespace {

using detail::LimbBuffer;
using Limb = BigInteger::Limb;
using Limbs = std::span<const Limb>;
__extension__ typedef unsigned __int128 Wide;

constexpr std::size_t kLimbBits = BigInteger::kLimbBits;
constexpr Limb kAllOnes = std::numeric_limits<Limb>::max();

constexpr Limb low(Wide x) { return static_cast<Limb>(x); }
constexpr Limb high(Wide x) { return static_cast<Limb>(x >> kLimbBits); }

std::strong_ordering compare(Limbs x, Limbs y) {
  if (x.size() != y.size()) return x.size() <=> y.size();
  for (std::size_t i = x.size(); i-- > 0;) {
    if (x[i] != y[i]) return x[i] <=> y[i];
  }
  return std::strong_ordering::equal;
}

/// x += y of m limbs, y may be x (algorithm A).
void add_magnitude(LimbBuffer& x, const LimbBuffer& y) {
  const std::size_t m = y.size(), n = std::max(x.size(), m);
  x.resize(n + 1);
  Limb* const to = x.data();
  const Limb* const from = y.data();
  Limb carry = 0;
  for (std::size_t i = 0; i < m; ++i) {
    const Wide sum = Wide{to[i]} + from[i] + carry;
    to[i] = low(sum);
    carry = high(sum);
  }
  for (std::size_t i = m; carry != 0; ++i) carry = ++to[i] == 0 ? 1 : 0;
  x.trim();
}

/// a[i] - b[i] with a borrow in and out (a step of algorithm S).
Limb subtract_step(Limb a, Limb b, Limb& borrow) {
  const Wide difference = Wide{a} - b - borrow;
  borrow = high(difference) != 0 ? 1 : 0;
  return low(difference);
}

/// x -= y <= x.
void subtract_magnitude(LimbBuffer& x, const LimbBuffer& y) {
  Limb* const to = x.data();
  const Limb* const from = y.data();
  Limb borrow = 0;
  for (std::size_t i = 0; i < y.size(); ++i) to[i] = subtract_step(to[i], from[i], borrow);
  for (std::size_t i = y.size(); borrow != 0; ++i) borrow = to[i]-- == 0 ? 1 : 0;
  x.trim();
}

/// x = y - x, x <= y.
void subtract_from_magnitude(LimbBuffer& x, const LimbBuffer& y) {
  x.resize(y.size());
  Limb* const to = x.data();
  const Limb* const from = y.data();
  Limb borrow = 0;
  for (std::size_t i = 0; i < y.size(); ++i) to[i] = subtract_step(from[i], to[i], borrow);
  x.trim();
}

/// to[0 .. n) += x[0 .. n) y; returns what is carried out.
Limb add_product(Limb* to, Limbs x, Limb y) {
  Limb carry = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Wide t = Wide{x[i]} * y + to[i] + carry;
    to[i] = low(t);
    carry = high(t);
  }
  return carry;
}

/// to[0 .. n) -= x[0 .. n) y; returns what is borrowed.
Limb subtract_product(Limb* to, Limbs x, Limb y) {
  Limb borrow = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Wide t = Wide{x[i]} * y + borrow;
    borrow = high(t) + (to[i] < low(t) ? 1 : 0);
    to[i] -= low(t);
  }
  return borrow;
}

/// 64 bits of x from bit k on.
Limb bits_from(Limbs x, std::size_t k) {
  const std::size_t i = k / kLimbBits, shift = k % kLimbBits;
  const Limb first = i < x.size() ? x[i] : 0, next = i + 1 < x.size() ? x[i + 1] : 0;
  return shift == 0 ? first : (first >> shift) | (next << (kLimbBits - shift));
}

/// x / y for one limb y, x becoming the quotient; returns the remainder.
Limb divide_by_limb(LimbBuffer& x, Limb y) {
  Limb remainder = 0;
  for (std::size_t i = x.size(); i-- > 0;) {
    const Wide dividend = (Wide{remainder} << kLimbBits) | x[i];
    x[i] = low(dividend / y);
    remainder = low(dividend % y);
  }
  x.trim();
  return remainder;
}

/// A digit of a quotient, at most one too large: step D3. `top` are the three leading limbs of the dividend,
/// the highest first, v the two leading limbs of the normalised divisor.
Limb trial_digit(const std::array<Limb, 3>& top, const std::array<Limb, 2>& v) {
  const Wide leading = (Wide{top[0]} << kLimbBits) | top[1];
  // The dividend's part is below the divisor times 2^64, so only the equal case overflows a limb.
  Limb digit = kAllOnes;
  Wide rest = Wide{top[1]} + v[0];
  if (top[0] < v[0]) {
    digit = low(leading / v[0]);
    rest = leading % v[0];
  }
  while (high(rest) == 0 && Wide{digit} * v[1] > ((rest << kLimbBits) | top[2])) {
    --digit;
    rest += v[0];
  }
  return digit;
}

/// Algorithm D. u (with a further leading limb, maybe zero) becomes the remainder; v has its top bit set and
/// at least two limbs.
LimbBuffer divide_normalised(LimbBuffer& u, Limbs v) {
  const std::size_t n = v.size(), m = u.size() - n;
  LimbBuffer quotient;
  quotient.resize(m);
  for (std::size_t j = m; j-- > 0;) {
    Limb* const part = u.data() + j;
    Limb digit = trial_digit({part[n], part[n - 1], part[n - 2]}, {v[n - 1], v[n - 2]});
    const Limb borrow = subtract_product(part, v, digit);
    const bool too_large = part[n] < borrow;
    part[n] -= borrow;
    if (too_large) {
      // Step D6, taken about twice in 2^64 digits: the digit was one too large.
      --digit;
      part[n] += add_product(part, v, 1);
    }
    quotient[j] = digit;
  }
  quotient.trim();
  u.trim();
  return quotient;
}

/// x 2^e rounded to the nearest double, ties to even.
double rounded(const BigInteger& x, long e) {
  constexpr long kDigits = 53, kLowest = -1074, kHighest = 1023;
  if (x.is_zero()) return 0;
  const auto length = static_cast<long>(x.bit_length());
  const double sign = x.sign();
  const long top = e + length - 1;
  if (top > kHighest) return sign * std::numeric_limits<double>::infinity();
  if (top < kLowest - 1) return sign * 0.0;
  // What lies below the last place that a double of this size has is cut off and decides the rounding.
  const long cut = std::max(length - kDigits, kLowest - e);
  if (cut <= 0) return sign * std::ldexp(static_cast<double>(x.limbs()[0]), static_cast<int>(e));
  const auto place = static_cast<std::size_t>(cut);
  Limb digits = bits_from(x.limbs(), place);
  const bool half = (bits_from(x.limbs(), place - 1) & 1U) != 0;
  if (half && ((digits & 1U) != 0 || x.trailing_zeros() < place - 1)) ++digits;
  return sign * std::ldexp(static_cast<double>(digits), static_cast<int>(e + cut));
}

/// A finite double as significand * 2^exponent, the significand odd or zero.
struct Parts {
  Limb significand;
  long exponent;
};
Parts parts_of(double x) {
  if (x == 0) return {0, 0};
  constexpr int kDigits = 53;
  int exponent = 0;
  const double fraction = std::frexp(std::fabs(x), &exponent);
  const Limb bits = static_cast<Limb>(std::ldexp(fraction, kDigits));
  const int zeros = std::countr_zero(bits);
  return {bits >> static_cast<unsigned>(zeros), exponent - kDigits + zeros};
}

}  // namespace

BigInteger::BigInteger(double x) {
  const Parts parts = parts_of(x);
  *this = BigInteger(parts.significand);
  if (parts.exponent >= 0) {
    *this <<= static_cast<std::size_t>(parts.exponent);
  } else {
    *this >>= static_cast<std::size_t>(-parts.exponent);
  }
  if (x < 0) negate();
}

BigInteger BigInteger::from_limbs(std::span<const Limb> limbs, bool negative) {
  BigInteger x;
  x.magnitude_.resize(limbs.size());
  std::copy(limbs.begin(), limbs.end(), x.magnitude_.data());
  x.magnitude_.trim();
  x.negative_ = negative && !x.is_zero();
  return x;
}

BigInteger BigInteger::power_of_two(std::size_t k) { return BigInteger(1) << k; }

std::size_t BigInteger::bit_length() const {
  if (is_zero()) return 0;
  const std::size_t last = magnitude_.size() - 1;
  return kLimbBits * last + static_cast<std::size_t>(std::bit_width(magnitude_[last]));
}

std::size_t BigInteger::trailing_zeros() const {
  if (is_zero()) return 0;
  std::size_t i = 0;
  while (magnitude_[i] == 0) ++i;
  return kLimbBits * i + static_cast<std::size_t>(std::countr_zero(magnitude_[i]));
}

double BigInteger::to_double() const { return rounded(*this, 0); }
DoubleDouble BigInteger::to_double_double() const { return Dyadic(*this).to_double_double(); }

void BigInteger::add(const BigInteger& y, bool y_negative) {
  if (negative_ == y_negative) return add_magnitude(magnitude_, y.magnitude_);
  const auto order = compare(limbs(), y.limbs());
  if (order >= 0) {
    subtract_magnitude(magnitude_, y.magnitude_);
  } else {
    subtract_from_magnitude(magnitude_, y.magnitude_);
    negative_ = y_negative;
  }
  if (is_zero()) negative_ = false;
}

BigInteger& BigInteger::operator+=(const BigInteger& y) {
  if (!y.is_zero()) add(y, y.negative_);
  return *this;
}
BigInteger& BigInteger::operator-=(const BigInteger& y) {
  if (!y.is_zero()) add(y, !y.negative_);
  return *this;
}

BigInteger operator*(const BigInteger& x, const BigInteger& y) {
  const BigInteger& longer = x.magnitude_.size() < y.magnitude_.size() ? y : x;
  const BigInteger& shorter = &longer == &x ? y : x;
  const Limbs a = longer.limbs(), b = shorter.limbs();
  BigInteger product;
  if (b.empty()) return product;
  product.magnitude_.resize(a.size() + b.size());
  Limb* const to = product.magnitude_.data();
  for (std::size_t j = 0; j < b.size(); ++j) to[j + a.size()] = add_product(to + j, a, b[j]);
  product.magnitude_.trim();
  product.negative_ = x.negative_ != y.negative_;
  return product;
}

BigInteger& BigInteger::operator<<=(std::size_t k) {
  if (is_zero() || k == 0) return *this;
  const std::size_t whole = k / kLimbBits, shift = k % kLimbBits, n = magnitude_.size();
  magnitude_.resize(n + whole + 1);
  Limb* const limbs = magnitude_.data();
  // From the top down, so that nothing is overwritten before it is read.
  for (std::size_t i = n + 1; i-- > 0;) {
    const Limb here = i < n ? limbs[i] : 0, below = i > 0 ? limbs[i - 1] : 0;
    limbs[i + whole] = shift == 0 ? here : (here << shift) | (below >> (kLimbBits - shift));
  }
  std::fill_n(limbs, whole, Limb{0});
  magnitude_.trim();
  return *this;
}

BigInteger& BigInteger::operator>>=(std::size_t k) {
  if (is_zero() || k == 0) return *this;
  const bool round_away = negative_ && trailing_zeros() < k;
  const std::size_t n = magnitude_.size(), kept = n - std::min(n, k / kLimbBits);
  for (std::size_t i = 0; i < kept; ++i) magnitude_[i] = bits_from(limbs(), k + i * kLimbBits);
  magnitude_.resize(kept);
  magnitude_.trim();
  if (is_zero()) negative_ = false;
  if (round_away) *this -= 1;
  return *this;
}

bool operator==(const BigInteger& x, const BigInteger& y) {
  return x.negative_ == y.negative_ && compare(x.limbs(), y.limbs()) == 0;
}

std::strong_ordering operator<=>(const BigInteger& x, const BigInteger& y) {
  if (x.negative_ != y.negative_) return y.negative_ <=> x.negative_;
  return x.negative_ ? compare(y.limbs(), x.limbs()) : compare(x.limbs(), y.limbs());
}

BigInteger::Division BigInteger::divide(const BigInteger& x, const BigInteger& y) {
  if (y.is_zero() || compare(x.limbs(), y.limbs()) < 0) return {BigInteger(), x};
  Division result;
  if (y.magnitude_.size() == 1) {
    result.quotient = x;
    result.remainder = BigInteger(divide_by_limb(result.quotient.magnitude_, y.magnitude_[0]));
  } else {
    // Step D1: a divisor with its top bit set makes trial digits at most two too large.
    const auto shift = static_cast<std::size_t>(std::countl_zero(y.limbs().back()));
    const BigInteger divisor = y << shift;
    BigInteger rest = x << shift;
    rest.magnitude_.resize(x.magnitude_.size() + 1);
    result.quotient.magnitude_ = divide_normalised(rest.magnitude_, divisor.limbs());
    rest.negative_ = false;
    result.remainder = std::move(rest >>= shift);
  }
  result.quotient.negative_ = x.negative_ != y.negative_ && !result.quotient.is_zero();
  result.remainder.negative_ = x.negative_ && !result.remainder.is_zero();
  return result;
}

BigInteger gcd(BigInteger x, BigInteger y) {
  x = abs(std::move(x));
  y = abs(std::move(y));
  if (x < y) std::swap(x, y);
  while (y.limbs().size() > 1) {
    x = x % y;
    std::swap(x, y);
  }
  if (y.is_zero()) return x;
  const Limb small = y.limbs()[0];
  const BigInteger rest = x % y;
  return {std::gcd(rest.is_zero() ? Limb{0} : rest.limbs()[0], small)};
}

Dyadic::Dyadic(double x) {
  const Parts parts = parts_of(x);
  mantissa_ = BigInteger(parts.significand);
  if (x < 0) mantissa_.negate();
  exponent_ = parts.exponent;
}

void Dyadic::normalise() {
  const std::size_t zeros = mantissa_.trailing_zeros();
  mantissa_ >>= zeros;
  exponent_ = mantissa_.is_zero() ? 0 : exponent_ + static_cast<long>(zeros);
}

double Dyadic::to_double() const { return rounded(mantissa_, exponent_); }

double Dyadic::round_down() const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const double nearest = to_double();
  if (nearest == -kInfinity) return nearest;
  const bool above = nearest == kInfinity || Dyadic(nearest) > *this;
  return above ? std::nextafter(nearest, -kInfinity) : nearest;
}

DoubleDouble Dyadic::to_double_double() const {
  const double head = to_double();
  if (!std::isfinite(head)) return {head, 0};
  const DoubleDouble pair{head, (*this - Dyadic(head)).to_double()};
  // A rest just below half an ulp may round to it; the pair must still be one that rounds to its own head.
  const DoubleDouble normalised = quick_two_sum(pair.hi, pair.lo);
  return std::isfinite(normalised.hi) ? normalised : pair;
}

BigInteger Dyadic::floor_in_units_of(long k) const {
  if (exponent_ >= k) return mantissa_ << static_cast<std::size_t>(exponent_ - k);
  return mantissa_ >> static_cast<std::size_t>(k - exponent_);
}

Dyadic& Dyadic::operator+=(const Dyadic& y) {
  if (y.is_zero()) return *this;
  if (is_zero()) return *this = y;
  const long apart = exponent_ - y.exponent_;
  if (apart == 0) {
    mantissa_ += y.mantissa_;
    normalise();
  } else if (apart > 0) {
    // An odd number plus an even one is odd: nothing to normalise.
    mantissa_ <<= static_cast<std::size_t>(apart);
    mantissa_ += y.mantissa_;
    exponent_ = y.exponent_;
  } else {
    mantissa_ += y.mantissa_ << static_cast<std::size_t>(-apart);
  }
  return *this;
}

Dyadic operator*(const Dyadic& x, const Dyadic& y) {
  Dyadic product;
  product.mantissa_ = x.mantissa_ * y.mantissa_;
  if (!product.is_zero()) product.exponent_ = x.exponent_ + y.exponent_;
  return product;
}

std::strong_ordering operator<=>(const Dyadic& x, const Dyadic& y) {
  if (x.sign() != y.sign()) return x.sign() <=> y.sign();
  if (x.is_zero()) return std::strong_ordering::equal;
  const auto by_size = x.top_exponent() <=> y.top_exponent();
  if (by_size != 0) return x.sign() > 0 ? by_size : 0 <=> by_size;
  return (x - y).sign() <=> 0;
}

}  // namespace graze
