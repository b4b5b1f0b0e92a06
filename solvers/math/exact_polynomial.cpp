#include <graze/solvers/math/exact_polynomial.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace graze {
namespace {

using Coefficients = std::vector<BigInteger>;

void drop_leading_zeros(Coefficients& c) {
  while (!c.empty() && c.back().is_zero()) c.pop_back();
}

/// Takes out the greatest common power of two.
void strip_powers_of_two(Coefficients& c) {
  std::size_t common = std::numeric_limits<std::size_t>::max();
  for (const BigInteger& x : c) {
    if (!x.is_zero()) common = std::min(common, x.trailing_zeros());
    if (common == 0) return;
  }
  for (BigInteger& x : c) x >>= common;
}

/// Integers in the ratio of the given numbers, without a common factor 2.
Coefficients integers_like(std::span<const Dyadic> c) {
  long unit = std::numeric_limits<long>::max();
  for (const Dyadic& x : c) {
    if (!x.is_zero()) unit = std::min(unit, x.exponent());
  }
  Coefficients integers;
  integers.reserve(c.size());
  for (const Dyadic& x : c) integers.push_back(x.is_zero() ? BigInteger() : x.floor_in_units_of(unit));
  return integers;
}

Coefficients integers_like(std::span<const double> c) {
  std::vector<Dyadic> dyadics;
  dyadics.reserve(c.size());
  for (const double x : c) dyadics.emplace_back(x);
  return integers_like(std::span<const Dyadic>(dyadics));
}

/// c_i becomes sum_k C(i, k) c_k.
void binomial_transform(Coefficients& c) {
  for (std::size_t level = 1; level < c.size(); ++level) {
    for (std::size_t i = c.size(); i-- > level;) c[i] += c[i - 1];
  }
}

BigInteger power(const BigInteger& base, int exponent) {
  BigInteger result = 1;
  for (int i = 0; i < exponent; ++i) result *= base;
  return result;
}

// -------------------------------------------------------------------------------------------
// Residues modulo the Mersenne prime 2^61 - 1: most polynomials are coprime there, hence coprime.

using Residue = std::uint64_t;
__extension__ typedef unsigned __int128 Wide;
constexpr unsigned kPrimeBits = 61;
constexpr Residue kPrime = (Residue{1} << kPrimeBits) - 1;

constexpr Residue reduced(Wide x) {
  const Wide folded = (x & kPrime) + (x >> kPrimeBits);
  const Residue once = static_cast<Residue>(folded & kPrime) + static_cast<Residue>(folded >> kPrimeBits);
  return once >= kPrime ? once - kPrime : once;
}
constexpr Residue product(Residue x, Residue y) { return reduced(Wide{x} * y); }
constexpr Residue difference(Residue x, Residue y) { return x >= y ? x - y : x + (kPrime - y); }
std::vector<Residue> residues_of(const ExactPolynomial& p) {
  std::vector<Residue> residues;
  for (const BigInteger& c : p.coefficients()) {
    Residue x = 0;
    const auto limbs = c.limbs();
    for (std::size_t i = limbs.size(); i-- > 0;) x = reduced((Wide{x} << BigInteger::kLimbBits) | limbs[i]);
    residues.push_back(c.sign() < 0 ? difference(0, x) : x);
  }
  return residues;
}

/// a mod b but for a factor; the leading coefficient of b is not zero. Multiplying a by it costs less than
/// its inverse.
void reduce_by(std::vector<Residue>& a, const std::vector<Residue>& b) {
  while (a.size() >= b.size()) {
    const Residue factor = a.back();
    const std::size_t offset = a.size() - b.size();
    a.pop_back();
    for (Residue& x : a) x = product(x, b.back());
    for (std::size_t i = 0; i + 1 < b.size(); ++i)
      a[i + offset] = difference(a[i + offset], product(factor, b[i]));
    while (!a.empty() && a.back() == 0) a.pop_back();
  }
}

/// True proves that a and b have no common root. Where the prime divides no leading coefficient, a common
/// factor stays one, of the same degree, modulo the prime.
bool surely_coprime(const ExactPolynomial& a, const ExactPolynomial& b) {
  if (a.is_zero() || b.is_zero()) return false;
  std::vector<Residue> x = residues_of(a), y = residues_of(b);
  if (x.back() == 0 || y.back() == 0) return false;
  while (!y.empty()) {
    reduce_by(x, y);
    std::swap(x, y);
  }
  return x.size() == 1;
}

// ------------------------------------------------------------------------------------------------- Isolation

/// All real roots are below 2^k in magnitude: Fujiwara's 2 max |c_(n-i) / c_n|^(1/i), by bit lengths.
long root_bound_exponent(std::span<const BigInteger> c) {
  const std::size_t n = c.size() - 1;
  const auto leading = static_cast<long>(c[n].bit_length()) - 1;
  long exponent = std::numeric_limits<long>::min();
  for (std::size_t i = 1; i <= n; ++i) {
    if (c[n - i].is_zero()) continue;
    const long ratio = static_cast<long>(c[n - i].bit_length()) - leading, root = static_cast<long>(i);
    // The quotient rounded up, for either sign.
    exponent = std::max(exponent, ratio >= 0 ? (ratio + root - 1) / root : -(-ratio / root));
  }
  return exponent + 1;
}

/// p(x + k), in place.
void taylor_shift(Coefficients& c, const BigInteger& k) {
  if (k.is_zero()) return;
  const bool plus_one = k == 1, minus_one = k == -1;
  for (std::size_t start = 0; start + 1 < c.size(); ++start) {
    for (std::size_t i = c.size() - 1; i-- > start;) {
      if (plus_one) {
        c[i] += c[i + 1];
      } else if (minus_one) {
        c[i] -= c[i + 1];
      } else {
        c[i] += k * c[i + 1];
      }
    }
  }
}

/// The open interval (index 2^exponent, (index + 1) 2^exponent) with p's Bernstein coefficients there, but
/// for a positive factor.
struct Cell {
  Coefficients b;
  BigInteger index;
  long exponent = 0;

  [[nodiscard]] Dyadic lo() const { return Dyadic(index, exponent); }
  [[nodiscard]] Dyadic hi() const { return Dyadic(index + 1, exponent); }
};

/// b_i = sum_k C(i,k) / C(n,k) c_k; times n! that is sum_k C(i,k) k! (n-k)! c_k, in integers.
void power_to_bernstein(Coefficients& c) {
  const std::size_t n = c.size() - 1;
  std::vector<BigInteger> factorials{1};
  for (std::size_t k = 1; k <= n; ++k) factorials.push_back(factorials.back() * BigInteger(k));
  for (std::size_t k = 0; k <= n; ++k) c[k] *= factorials[k] * factorials[n - k];
  binomial_transform(c);
}

Cell make_cell(const ExactPolynomial& p, const BigInteger& index, long exponent) {
  const auto c = p.coefficients();
  Cell cell{{c.begin(), c.end()}, index, exponent};
  const std::size_t n = c.size() - 1, by = static_cast<std::size_t>(std::labs(exponent));
  for (std::size_t i = 0; i <= n; ++i) cell.b[i] <<= by * (exponent >= 0 ? i : n - i);
  taylor_shift(cell.b, index);
  power_to_bernstein(cell.b);
  strip_powers_of_two(cell.b);
  return cell;
}

/// de Casteljau's triangle at 1/2 in sums only: `cell` becomes its right half, the left one is returned. A
/// number of level k is 2^k times too large, so all are brought to level n.
Cell split(Cell& cell) {
  Coefficients& b = cell.b;
  const std::size_t n = b.size() - 1;
  Cell left{Coefficients(n + 1), cell.index << 1U, cell.exponent - 1};
  left.b[0] = b[0] << n;
  for (std::size_t level = 1; level <= n; ++level) {
    for (std::size_t i = 0; i + level <= n; ++i) b[i] += b[i + 1];
    left.b[level] = b[0] << (n - level);
  }
  for (std::size_t i = 0; i <= n; ++i) b[i] <<= i;
  strip_powers_of_two(left.b);
  strip_powers_of_two(b);
  cell.index = left.index + 1;
  --cell.exponent;
  return left;
}

/// 0, 1, or 2 for more: the changes of sign, zeros passed over.
int sign_changes(const Coefficients& b) {
  int changes = 0, last = 0;
  for (const BigInteger& x : b) {
    const int sign = x.sign();
    if (sign == 0) continue;
    if (last != 0 && sign != last && ++changes == 2) break;
    last = sign;
  }
  return changes;
}

/// The sign of the first coefficient that is not zero.
int sign_of_first(const Coefficients& b) {
  const auto first = std::find_if(b.begin(), b.end(), [](const BigInteger& x) { return !x.is_zero(); });
  return first == b.end() ? 0 : first->sign();
}

/// Subdivision of [lo, hi] until Descartes' rule says 0 or 1 for every part [CA]. Needs: p square-free.
class Search {
 public:
  struct Found {
    Dyadic lo;
    long width;
    bool exact;
  };

  Search(const ExactPolynomial& p, const Dyadic& lo, const Dyadic& hi) : p_(p), lo_(lo), hi_(hi) {}

  std::vector<Found> run() {
    start();
    while (!open_.empty()) {
      Cell cell = std::move(open_.back());
      open_.pop_back();
      const int changes = sign_changes(cell.b);
      if (changes == 0) continue;
      // A root at an end would leave no sign there: such a cell is halved on.
      if (changes == 1 && !cell.b.front().is_zero() && !cell.b.back().is_zero()) {
        keep_if_inside(cell);
      } else {
        halve(cell);
      }
    }
    std::sort(found_.begin(), found_.end(), [](const Found& a, const Found& b) {
      return a.lo == b.lo ? a.exact && !b.exact : a.lo < b.lo;
    });
    return std::move(found_);
  }

 private:
  /// One or two cells of the least size 2^e >= hi - lo.
  void start() {
    if (lo_ == hi_) {
      if (p_.sign_at(lo_) == 0) keep_exact(lo_);
      return;
    }
    const Dyadic length = hi_ - lo_;
    const long exponent = length.top_exponent() + (length.mantissa() == 1 ? 0 : 1);
    const BigInteger index = lo_.floor_in_units_of(exponent);
    Cell first = make_cell(p_, index, exponent);
    if (first.b.front().is_zero()) keep_exact(first.lo());
    if (first.b.back().is_zero()) keep_exact(first.hi());
    const bool reaches_beyond = first.hi() < hi_;
    open_.push_back(std::move(first));
    // The end of the second one lies beyond hi: it takes lo = index 2^e to reach as far, and then hi is in
    // the first.
    if (reaches_beyond) open_.push_back(make_cell(p_, index + 1, exponent));
  }
  void keep_exact(const Dyadic& x) {
    if (lo_ <= x && x <= hi_) found_.push_back({x, 0, true});
  }
  /// The one root of the cell, if it is not beyond an end of [lo, hi] that the cell sticks out of.
  void keep_if_inside(const Cell& cell) {
    const Dyadic lo = cell.lo();
    if (lo < lo_) {
      const int sign = p_.sign_at(lo_);
      if (sign == 0) return keep_exact(lo_);
      if (sign != cell.b.front().sign()) return;
    }
    if (hi_ < cell.hi()) {
      const int sign = p_.sign_at(hi_);
      if (sign == 0) return keep_exact(hi_);
      if (sign == cell.b.front().sign()) return;
    }
    found_.push_back({lo, cell.exponent, false});
  }
  void halve(Cell& cell) {
    Cell left = split(cell);
    const Dyadic middle = cell.lo();
    if (cell.b.front().is_zero()) keep_exact(middle);
    if (middle < hi_) open_.push_back(std::move(cell));
    if (lo_ < middle) open_.push_back(std::move(left));
  }

  const ExactPolynomial& p_;
  Dyadic lo_, hi_;
  std::vector<Cell> open_;
  std::vector<Found> found_;
};

/// A square-free factor that many roots share.
struct SharedFactor {
  std::shared_ptr<const ExactPolynomial> polynomial;
  int multiplicity;
};

/// The factor whose root was found: the one that vanishes, or the only one to change its sign.
const SharedFactor& factor_of(const std::vector<SharedFactor>& factors, const Search::Found& found) {
  const auto owns = [&](const SharedFactor& factor) {
    const int at_lo = factor.polynomial->sign_at(found.lo);
    if (found.exact) return at_lo == 0;
    return factor.polynomial->sign_at(found.lo + Dyadic::power_of_two(found.width)) != at_lo;
  };
  // Asking the last one is needless: it is the one if no other is.
  const auto last = std::prev(factors.end());
  return *std::find_if(factors.begin(), last, owns);
}

/// The roots other than zero of a polynomial with p(0) != 0.
void isolate_nonzero(const ExactPolynomial& p, const DyadicInterval& interval, std::vector<RealRoot>& roots) {
  if (p.degree() < 1) return;
  const long bound = root_bound_exponent(p.coefficients());
  const Dyadic most = Dyadic::power_of_two(bound);
  const Dyadic lo = interval.lo ? std::max(*interval.lo, -most) : -most;
  const Dyadic hi = interval.hi ? std::min(*interval.hi, most) : most;
  if (hi < lo) return;
  std::vector<SharedFactor> factors;
  ExactPolynomial simple;
  for (SquareFreeFactor& factor : square_free_factors(p)) {
    simple = factors.empty() ? factor.polynomial : simple * factor.polynomial;
    factors.push_back(
        {std::make_shared<const ExactPolynomial>(std::move(factor.polynomial)), factor.multiplicity});
  }
  for (const Search::Found& found : Search(simple, lo, hi).run()) {
    const SharedFactor& factor = factor_of(factors, found);
    if (found.exact) {
      roots.emplace_back(factor.polynomial, found.lo, factor.multiplicity);
    } else {
      roots.emplace_back(factor.polynomial, found.lo, found.width, factor.multiplicity);
    }
  }
}

}  // namespace

// ----------------------------------------------------------------------------------------------- Polynomials

ExactPolynomial::ExactPolynomial(std::vector<BigInteger> c) : c_(std::move(c)) { drop_leading_zeros(c_); }
ExactPolynomial::ExactPolynomial(std::span<const Dyadic> c) : ExactPolynomial(integers_like(c)) {}
ExactPolynomial::ExactPolynomial(std::span<const double> c) : ExactPolynomial(integers_like(c)) {}

ExactPolynomial ExactPolynomial::from_bernstein(std::span<const Dyadic> b) {
  // c_k = C(n,k) sum_i (-1)^(k-i) C(k,i) b_i: the sum is the k-th difference, a transform between two signs.
  Coefficients c = integers_like(b);
  for (std::size_t k = 1; k < c.size(); k += 2) c[k].negate();
  binomial_transform(c);
  BigInteger binomial = 1;
  for (std::size_t k = 0; k < c.size(); ++k) {
    c[k] *= binomial;
    if (k % 2 == 1) c[k].negate();
    binomial = exact_quotient(binomial * BigInteger(c.size() - 1 - k), BigInteger(k + 1));
  }
  strip_powers_of_two(c);
  return ExactPolynomial(std::move(c));
}

ExactPolynomial ExactPolynomial::derivative() const {
  Coefficients c;
  for (std::size_t i = 1; i < c_.size(); ++i) c.push_back(c_[i] * BigInteger(i));
  return ExactPolynomial(std::move(c));
}

BigInteger ExactPolynomial::content() const {
  BigInteger common;
  for (const BigInteger& c : c_) {
    common = gcd(std::move(common), c);
    if (common == 1) break;
  }
  return common;
}

ExactPolynomial ExactPolynomial::primitive_part() const {
  if (is_zero()) return {};
  Coefficients c = c_;
  strip_powers_of_two(c);
  BigInteger common = ExactPolynomial(c).content();
  if (leading().sign() < 0) common.negate();
  if (common != 1) {
    for (BigInteger& x : c) x = exact_quotient(x, common);
  }
  return ExactPolynomial(std::move(c));
}

Dyadic ExactPolynomial::value_at(const Dyadic& x) const {
  if (is_zero()) return {};
  const std::size_t n = c_.size() - 1;
  // Horner on integers: for x = m 2^-k, 2^(kn) p(x) = sum c_i m^i 2^(k(n-i)).
  const bool fraction = x.exponent() < 0;
  const std::size_t k = fraction ? static_cast<std::size_t>(-x.exponent()) : 0;
  const BigInteger m = fraction ? x.mantissa() : x.floor_in_units_of(0);
  BigInteger value = c_[n];
  for (std::size_t i = n; i-- > 0;) {
    value *= m;
    value += k == 0 ? c_[i] : c_[i] << (k * (n - i));
  }
  return Dyadic(std::move(value), -static_cast<long>(k * n));
}

int ExactPolynomial::sign_at(const Dyadic& x) const {
  if (x.is_zero()) return is_zero() ? 0 : c_[0].sign();
  return value_at(x).sign();
}

ExactPolynomial operator+(const ExactPolynomial& p, const ExactPolynomial& q) {
  Coefficients c = p.c_;
  c.resize(std::max(p.c_.size(), q.c_.size()));
  for (std::size_t i = 0; i < q.c_.size(); ++i) c[i] += q.c_[i];
  return ExactPolynomial(std::move(c));
}

ExactPolynomial operator-(const ExactPolynomial& p, const ExactPolynomial& q) {
  Coefficients c = p.c_;
  c.resize(std::max(p.c_.size(), q.c_.size()));
  for (std::size_t i = 0; i < q.c_.size(); ++i) c[i] -= q.c_[i];
  return ExactPolynomial(std::move(c));
}

ExactPolynomial operator*(const ExactPolynomial& p, const ExactPolynomial& q) {
  if (p.is_zero() || q.is_zero()) return {};
  Coefficients c(p.c_.size() + q.c_.size() - 1);
  for (std::size_t i = 0; i < p.c_.size(); ++i) {
    for (std::size_t k = 0; k < q.c_.size(); ++k) c[i + k] += p.c_[i] * q.c_[k];
  }
  return ExactPolynomial(std::move(c));
}

ExactPolynomial operator*(const ExactPolynomial& p, const BigInteger& factor) {
  Coefficients c = p.c_;
  for (BigInteger& x : c) x *= factor;
  return ExactPolynomial(std::move(c));
}

ExactPolynomial pseudo_remainder(const ExactPolynomial& a, const ExactPolynomial& b) {
  const auto divisor = b.coefficients();
  const int steps = a.degree() - b.degree() + 1;
  Coefficients rest(a.coefficients().begin(), a.coefficients().end());
  for (int step = 0; step < steps; ++step) {
    const BigInteger leading = rest.back();
    rest.pop_back();
    const std::size_t offset = rest.size() + 1 - divisor.size();
    for (BigInteger& x : rest) x *= b.leading();
    if (leading.is_zero()) continue;
    for (std::size_t i = 0; i + 1 < divisor.size(); ++i) rest[i + offset] -= leading * divisor[i];
  }
  return ExactPolynomial(std::move(rest));
}

ExactPolynomial exact_quotient(const ExactPolynomial& a, const ExactPolynomial& b) {
  if (a.degree() < b.degree()) return {};
  const auto divisor = b.coefficients();
  Coefficients rest(a.coefficients().begin(), a.coefficients().end());
  Coefficients quotient(rest.size() - divisor.size() + 1);
  for (std::size_t k = quotient.size(); k-- > 0;) {
    quotient[k] = exact_quotient(rest[k + divisor.size() - 1], divisor.back());
    for (std::size_t i = 0; i < divisor.size(); ++i) rest[i + k] -= quotient[k] * divisor[i];
  }
  return ExactPolynomial(std::move(quotient));
}

namespace {

/// Two neighbours of the sequence of subresultants, the remainders divided by what is known to divide them:
/// the least integers that need no common divisors [BT]. Needs: deg a >= deg b.
struct Subresultants {
  ExactPolynomial a, b;
  BigInteger g = 1, h = 1;

  void advance() {
    const int apart = a.degree() - b.degree();
    const ExactPolynomial rest = pseudo_remainder(a, b);
    a = std::move(b);
    const BigInteger divisor = g * power(h, apart);
    Coefficients c;
    for (const BigInteger& x : rest.coefficients()) c.push_back(exact_quotient(x, divisor));
    b = ExactPolynomial(std::move(c));
    g = a.leading();
    if (apart > 0) h = exact_quotient(power(g, apart), power(h, apart - 1));
  }
};

}  // namespace

ExactPolynomial gcd(const ExactPolynomial& p, const ExactPolynomial& q) {
  const ExactPolynomial one(Coefficients{1});
  if (surely_coprime(p, q)) return one;
  ExactPolynomial a = p.primitive_part(), b = q.primitive_part();
  if (a.degree() < b.degree()) std::swap(a, b);
  Subresultants sequence{std::move(a), std::move(b)};
  while (sequence.b.degree() > 0) sequence.advance();
  return sequence.b.is_zero() ? sequence.a.primitive_part() : one;
}

BigInteger resultant(const ExactPolynomial& p, const ExactPolynomial& q) {
  if (p.is_zero() || q.is_zero()) return 0;
  Subresultants sequence{p, q};
  ExactPolynomial &a = sequence.a, &b = sequence.b;
  bool negative = false;
  const auto are_odd = [&] { return a.degree() % 2 == 1 && b.degree() % 2 == 1; };
  if (a.degree() < b.degree()) {
    negative = are_odd();
    std::swap(a, b);
  }
  while (b.degree() > 0) {
    if (are_odd()) negative = !negative;
    sequence.advance();
  }
  if (b.is_zero()) return 0;
  const int n = a.degree();
  const BigInteger value =
      n > 0 ? exact_quotient(power(b.leading(), n), power(sequence.h, n - 1)) : BigInteger(1);
  return negative ? -value : value;
}

ExactPolynomial image_polynomial(const ExactPolynomial& f, const ExactPolynomial& p) {
  const auto n = static_cast<std::size_t>(f.degree());
  Coefficients differences;
  for (std::size_t y = 0; y <= n; ++y)
    differences.push_back(resultant(f, ExactPolynomial(Coefficients{BigInteger(y)}) - p));
  // Newton's forward differences; times n! every coefficient of the interpolant is an integer.
  for (std::size_t level = 1; level <= n; ++level) {
    for (std::size_t i = n; i >= level; --i) differences[i] -= differences[i - 1];
  }
  BigInteger factor = 1;
  ExactPolynomial image;
  for (std::size_t i = n + 1; i-- > 0;) {
    image = image * ExactPolynomial(Coefficients{-BigInteger(i), 1}) +
            ExactPolynomial(Coefficients{differences[i] * factor});
    factor *= BigInteger(i);
  }
  return image;
}

std::vector<SquareFreeFactor> square_free_factors(const ExactPolynomial& p) {
  if (p.degree() < 1) return {};
  if (surely_coprime(p, p.derivative())) return {{p, 1}};
  const ExactPolynomial f = p.primitive_part(), slope = f.derivative(), common = gcd(f, slope);
  std::vector<SquareFreeFactor> factors;
  ExactPolynomial b = exact_quotient(f, common);
  ExactPolynomial d = exact_quotient(slope, common) - b.derivative();
  for (int multiplicity = 1; b.degree() > 0; ++multiplicity) {
    const ExactPolynomial factor = gcd(b, d);
    b = exact_quotient(b, factor);
    d = exact_quotient(d, factor) - b.derivative();
    if (factor.degree() > 0) factors.push_back({factor, multiplicity});
  }
  return factors;
}

// ----------------------------------------------------------------------------------------------------- Roots

DyadicInterval dyadic_interval(double lo, double hi) {
  const auto end = [](double x) { return std::isinf(x) ? std::optional<Dyadic>() : Dyadic(x); };
  DyadicInterval interval{end(lo), end(hi)};
  // An interval at infinity holds no number; an empty one says so.
  const bool empty = !(lo <= hi) || (std::isinf(lo) && lo == hi);
  return empty ? DyadicInterval{Dyadic(1.0), Dyadic()} : interval;
}

RealRoot::RealRoot(std::shared_ptr<const ExactPolynomial> p, const Dyadic& x, int multiplicity)
    : polynomial_(std::move(p)), lo_(x), hi_(x), multiplicity_(multiplicity) {}

RealRoot::RealRoot(std::shared_ptr<const ExactPolynomial> p, const Dyadic& lo, long width, int multiplicity)
    : polynomial_(std::move(p)),
      lo_(lo),
      hi_(lo + Dyadic::power_of_two(width)),
      width_(width),
      multiplicity_(multiplicity) {}

/// The polynomial at both ends.
struct RealRoot::Ends {
  Dyadic lo, hi;
};

void RealRoot::refine(long width) {
  if (is_exact() || width_ <= width) return;
  Ends values{polynomial_->value_at(lo_), polynomial_->value_at(hi_)};
  while (!is_exact() && width_ > width) refine_once(width_ - width, values);
}

void RealRoot::bisect(Ends& values) {
  const Dyadic middle = lo_ + Dyadic::power_of_two(width_ - 1);
  const Dyadic value = polynomial_->value_at(middle);
  if (value.is_zero()) return become(middle);
  --width_;
  const bool in_right = value.sign() == values.lo.sign();
  (in_right ? lo_ : hi_) = middle;
  (in_right ? values.lo : values.hi) = value;
}

bool RealRoot::narrow_to(const BigInteger& line, long bits, Ends& values) {
  const long unit = width_ - bits;
  const auto at = [&](const BigInteger& k) { return lo_ + Dyadic(k, unit); };
  const BigInteger last = BigInteger::power_of_two(static_cast<std::size_t>(bits));
  const auto value_at = [&](const BigInteger& k) {
    return k.is_zero() ? values.lo : k == last ? values.hi : polynomial_->value_at(at(k));
  };
  const Dyadic value = value_at(line);
  if (value.is_zero()) {
    become(at(line));
    return true;
  }
  // The sign at the line says on which side of it the root is; is it in the next cell there?
  const bool right = value.sign() == values.lo.sign();
  const BigInteger other = right ? line + 1 : line - 1;
  const Dyadic other_value = value_at(other);
  if (other_value.is_zero()) {
    become(at(other));
    return true;
  }
  if (other_value.sign() == value.sign()) return false;
  const Dyadic from = at(right ? line : other);
  values = right ? Ends{value, other_value} : Ends{other_value, value};
  lo_ = from;
  hi_ = from + Dyadic::power_of_two(unit);
  width_ = unit;
  return true;
}

void RealRoot::refine_once(long most_bits, Ends& values) {
  const long bits = std::min(jump_, most_bits);
  if (bits > 1) {
    // The line of a grid of 2^bits cells that is nearest to the secant's zero; some bits more than the grid
    // has are enough to find it.
    constexpr long kMoreBits = 8;
    const Dyadic below = abs(values.lo), above = abs(values.hi);
    const long unit = std::max(below.top_exponent(), above.top_exponent()) - bits - kMoreBits;
    const BigInteger a = below.floor_in_units_of(unit), b = above.floor_in_units_of(unit);
    const BigInteger line = (((a << static_cast<std::size_t>(bits + 1)) / (a + b)) + 1) >> 1U;
    if (narrow_to(line, bits, values)) {
      jump_ = 2 * bits;
      return;
    }
  }
  bisect(values);
  jump_ = std::max(jump_ / 2, 2L);
}

int RealRoot::compare_with(const Dyadic& x) const {
  if (is_exact()) return (lo_ - x).sign();
  if (x <= lo_) return 1;
  if (x >= hi_) return -1;
  const int sign = polynomial_->sign_at(x);
  if (sign == 0) return 0;
  return sign == polynomial_->sign_at(lo_) ? 1 : -1;
}

template <class Number>
Number RealRoot::rounded(Number (Dyadic::*round)() const, const Dyadic& origin, long digits) {
  // Rounding is monotone, so equal roundings of both ends are the root's. A root never stays between two:
  // where the roundings part is a dyadic, which refinement reaches or leaves behind.
  constexpr long kLowest = -1074;
  for (long more = 4;; more *= 2) {
    const Dyadic lo = lo_ + origin, hi = hi_ + origin;
    const Number below = (lo.*round)(), above = (hi.*round)();
    if (below == above) return above;
    const bool sized = !lo.is_zero() && !hi.is_zero();
    const long size = sized ? std::max(lo.top_exponent(), hi.top_exponent()) : width_;
    refine(std::min(std::max(size - digits, kLowest) - more, width_ - more));
  }
}

double RealRoot::to_double_from(const Dyadic& origin) { return rounded(&Dyadic::to_double, origin, 53); }
DoubleDouble RealRoot::to_double_double() { return rounded(&Dyadic::to_double_double, Dyadic(), 107); }

std::strong_ordering compare(RealRoot a, RealRoot b) {
  if (b.is_exact()) return a.compare_with(b.lo()) <=> 0;
  if (a.is_exact()) return 0 <=> b.compare_with(a.lo());
  const auto overlap = [&] { return a.lo() < b.hi() && b.lo() < a.hi(); };
  if (overlap()) {
    // Equal roots are a root of the common divisor, which changes its sign where both intervals are.
    const ExactPolynomial common = gcd(a.polynomial(), b.polynomial());
    const Dyadic lo = std::max(a.lo(), b.lo()), hi = std::min(a.hi(), b.hi());
    if (common.sign_at(lo) != common.sign_at(hi)) return std::strong_ordering::equal;
  }
  while (overlap()) {
    const long width = std::min((a.hi() - a.lo()).top_exponent(), (b.hi() - b.lo()).top_exponent()) - 4;
    a.refine(width);
    b.refine(width);
    if (a.is_exact() || b.is_exact()) return compare(std::move(a), std::move(b));
  }
  return a.lo() <=> b.lo();
}

int sign_at(const ExactPolynomial& q, RealRoot x) {
  if (x.is_exact() || q.is_zero()) return q.sign_at(x.lo());
  const ExactPolynomial common = gcd(q, x.polynomial());
  if (common.sign_at(x.lo()) != common.sign_at(x.hi())) return 0;
  // The root is none of q: soon there is none of q's in its interval, and Descartes' rule says so.
  for (long more = 4;; more *= 2) {
    if (x.is_exact()) return q.sign_at(x.lo());
    const long width = (x.hi() - x.lo()).exponent();
    const Cell cell = make_cell(q, x.lo().floor_in_units_of(width), width);
    if (sign_changes(cell.b) == 0) return sign_of_first(cell.b);
    x.refine(width - more);
  }
}

DyadicBounds bounds_at(const ExactPolynomial& p, const RealRoot& x) {
  const Dyadic value = p.value_at(x.lo());
  if (x.is_exact()) return {value, value};
  const Dyadic most = std::max(abs(x.lo()), abs(x.hi()));
  const long exponent = std::max(most.top_exponent() + 1, 0L);
  // |p'| <= sum i |c_i| 2^(k (i - 1)) for |x| <= 2^k.
  Dyadic slope;
  const auto c = p.coefficients();
  for (std::size_t i = 1; i < c.size(); ++i)
    slope += Dyadic(abs(c[i]) * BigInteger(i), exponent * static_cast<long>(i - 1));
  const Dyadic radius = slope * (x.hi() - x.lo());
  return {value - radius, value + radius};
}

namespace {

/// p(x) among the roots of its image polynomial: refined until one is left.
std::size_t find_image(RealRoot x, const ExactPolynomial& p, std::vector<RealRoot> images) {
  constexpr long kFirstBits = 64;
  std::vector<std::size_t> left(images.size());
  std::iota(left.begin(), left.end(), std::size_t{0});
  for (long bits = kFirstBits; left.size() > 1; bits *= 2) {
    x.refine(-bits);
    const DyadicBounds value = bounds_at(p, x);
    for (const std::size_t i : left) images[i].refine(-bits);
    std::erase_if(left,
                  [&](std::size_t i) { return images[i].hi() < value.lo || value.hi < images[i].lo(); });
  }
  return left.front();
}

}  // namespace

bool have_equal_images(RealRoot a, RealRoot b, const ExactPolynomial& p) {
  if (p.degree() < 1) return true;
  if (a.is_exact()) std::swap(a, b);
  if (b.is_exact()) {
    // Times the power of two that makes the difference from p(b) integers.
    const Dyadic value = p.value_at(b.lo());
    const long unit = std::min(value.exponent(), 0L);
    const ExactPolynomial shift(Coefficients{value.floor_in_units_of(unit)});
    return sign_at(p * BigInteger::power_of_two(static_cast<std::size_t>(-unit)) - shift, a) == 0;
  }
  const bool same = &a.polynomial() == &b.polynomial();
  const ExactPolynomial image = image_polynomial(same ? a.polynomial() : a.polynomial() * b.polynomial(), p);
  const std::vector<RealRoot> images = isolate_roots(image);
  return find_image(a, p, images) == find_image(b, p, images);
}

std::vector<RealRoot> isolate_roots(const ExactPolynomial& p, const DyadicInterval& interval) {
  if (p.is_zero() || (interval.lo && interval.hi && *interval.hi < *interval.lo)) return {};
  // Powers of x are taken out first: a ray that starts on a surface has one, and it needs no arithmetic.
  const auto c = p.coefficients();
  const auto first = std::find_if(c.begin(), c.end(), [](const BigInteger& x) { return !x.is_zero(); });
  std::vector<RealRoot> roots;
  if (first == c.begin()) {
    isolate_nonzero(p, interval, roots);
    return roots;
  }
  isolate_nonzero(ExactPolynomial(Coefficients(first, c.end())), interval, roots);
  if ((interval.lo && interval.lo->sign() > 0) || (interval.hi && interval.hi->sign() < 0)) return roots;
  const auto place = std::find_if(roots.begin(), roots.end(),
                                  [](const RealRoot& root) { return root.compare_with(Dyadic()) > 0; });
  const auto x = std::make_shared<const ExactPolynomial>(Coefficients{0, 1});
  roots.insert(place, RealRoot(x, Dyadic(), static_cast<int>(first - c.begin())));
  return roots;
}

std::size_t count_roots(const ExactPolynomial& p, const DyadicInterval& interval) {
  return isolate_roots(p, interval).size();
}

}  // namespace graze
