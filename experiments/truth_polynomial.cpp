#include <algorithm>
#include <bit>
#include <cmath>
#include <graze/experiments/truth_polynomial.hpp>

namespace graze::truth {
namespace {

__extension__ typedef unsigned __int128 Wide;
using Residues = std::vector<std::uint64_t>;

// 2^61 - 1, a prime whose remainder is a shift and an addition.
constexpr std::uint64_t kMersenne61 = (std::uint64_t{1} << 61) - 1;

mpz_ptr raw(Integer& a) { return a.backend().data(); }
mpz_srcptr raw(const Integer& a) { return a.backend().data(); }
auto bit_count(long k) { return static_cast<mp_bitcnt_t>(k); }

/// Arithmetic modulo a prime below 2^62.
struct Field {
  std::uint64_t p;

  [[nodiscard]] std::uint64_t mul(std::uint64_t a, std::uint64_t b) const {
    const Wide c = static_cast<Wide>(a) * b;
    if (p != kMersenne61) return static_cast<std::uint64_t>(c % p);
    const std::uint64_t folded = (static_cast<std::uint64_t>(c) & p) + static_cast<std::uint64_t>(c >> 61);
    return folded >= p ? folded - p : folded;
  }
  [[nodiscard]] std::uint64_t add(std::uint64_t a, std::uint64_t b) const {
    return a + b >= p ? a + b - p : a + b;
  }
  [[nodiscard]] std::uint64_t sub(std::uint64_t a, std::uint64_t b) const {
    return a >= b ? a - b : a + p - b;
  }
  [[nodiscard]] std::uint64_t inverse(std::uint64_t a) const {
    std::uint64_t result = 1;
    for (std::uint64_t e = p - 2; e != 0; e >>= 1, a = mul(a, a))
      if ((e & 1) != 0) result = mul(result, a);
    return result;
  }
  [[nodiscard]] std::uint64_t of(const Integer& a) const { return mpz_fdiv_ui(raw(a), p); }
};

Residues residues(const Polynomial& p, const Field& field) {
  Residues r(p.size());
  for (std::size_t i = 0; i < p.size(); ++i) r[i] = field.of(p[i]);
  while (!r.empty() && r.back() == 0) r.pop_back();
  return r;
}

/// a <- lc(b)^j a mod b, fraction-free; returns j.
long pseudo_remainder(Residues& a, const Residues& b, const Field& field) {
  long steps = 0;
  while (a.size() >= b.size()) {
    const std::uint64_t top = a.back();
    const std::size_t offset = a.size() - b.size();
    for (auto& c : a) c = field.mul(c, b.back());
    for (std::size_t i = 0; i < b.size(); ++i) a[offset + i] = field.sub(a[offset + i], field.mul(top, b[i]));
    while (!a.empty() && a.back() == 0) a.pop_back();
    ++steps;
  }
  return steps;
}

Residues gcd(Residues a, Residues b, const Field& field) {
  if (a.size() < b.size()) std::swap(a, b);
  while (!b.empty()) {
    if (b.size() == 1) return {1};
    pseudo_remainder(a, b, field);
    std::swap(a, b);
  }
  return a;
}

std::uint64_t power(std::uint64_t a, long e, const Field& field) {
  std::uint64_t result = 1;
  for (; e != 0; e >>= 1, a = field.mul(a, a))
    if ((e & 1) != 0) result = field.mul(result, a);
  return result;
}

/// Res(a, b) by Euclid's algorithm.
std::uint64_t resultant(Residues a, Residues b, const Field& field) {
  std::uint64_t result = 1;
  std::uint64_t divisor = 1;
  while (true) {
    if (a.empty() || b.empty()) return 0;
    if (b.size() == 1) break;
    const auto m = static_cast<long>(a.size()) - 1;
    const auto n = static_cast<long>(b.size()) - 1;
    const std::uint64_t top = b.back();
    const long steps = pseudo_remainder(a, b, field);
    if (a.empty()) return 0;
    // Res(a, b) = (-1)^(m n) Res(b, a) and Res(b, a) = lc(b)^(m - deg r) Res(b, r) for a = q b + r.
    const auto r = static_cast<long>(a.size()) - 1;
    if ((m & n & 1) != 0) result = field.sub(0, result);
    result = field.mul(result, power(top, m - r, field));
    divisor = field.mul(divisor, power(power(top, steps, field), n, field));
    std::swap(a, b);
  }
  result = field.mul(result, power(b[0], static_cast<long>(a.size()) - 1, field));
  return field.mul(result, field.inverse(divisor));
}

/// Primes from 2^61 - 1 upwards. GMP's primality test is proved below 2^64.
std::uint64_t next_prime(std::uint64_t p) {
  Integer q(p);
  mpz_nextprime(raw(q), raw(q));
  return mpz_get_ui(raw(q));
}

/// Coefficients known modulo a growing product of primes.
class ChineseRemainder {
 public:
  void restart() {
    modulus_ = 1;
    values_.clear();
  }
  void join(const Residues& r, const Field& field) {
    values_.resize(std::max(values_.size(), r.size()));
    const std::uint64_t inverse = field.inverse(field.of(modulus_));
    for (std::size_t i = 0; i < values_.size(); ++i) {
      const std::uint64_t wanted = i < r.size() ? r[i] : 0;
      const std::uint64_t step = field.mul(field.sub(wanted, field.of(values_[i])), inverse);
      mpz_addmul_ui(raw(values_[i]), raw(modulus_), step);
    }
    mpz_mul_ui(raw(modulus_), raw(modulus_), field.p);
  }
  /// The representatives nearest to zero.
  [[nodiscard]] Polynomial symmetric() const {
    Polynomial p = values_;
    for (auto& c : p)
      if (2 * c > modulus_) c -= modulus_;
    trim(p);
    return p;
  }
  [[nodiscard]] const Integer& modulus() const { return modulus_; }

 private:
  Integer modulus_ = 1;
  Polynomial values_;
};

/// The polynomial through (i, values[i]), i = 0, 1, ..., by Newton's divided differences.
Residues interpolate(Residues values, const Field& field) {
  const std::size_t n = values.size();
  for (std::size_t j = 1; j < n; ++j) {
    const std::uint64_t inverse = field.inverse(j);
    for (std::size_t i = n; i-- > j;) values[i] = field.mul(field.sub(values[i], values[i - 1]), inverse);
  }
  Residues p;
  for (std::size_t j = n; j-- > 0;) {
    p.insert(p.begin(), 0);
    for (std::size_t i = 0; i + 1 < p.size(); ++i) p[i] = field.sub(p[i], field.mul(p[i + 1], j));
    p[0] = field.add(p[0], values[j]);
  }
  return p;
}

Integer norm1(const Polynomial& p) {
  Integer sum = 0;
  for (const auto& c : p) sum += abs(c);
  return sum;
}

/// p(x) = factor * (2^k x - m): the quotient, for a root m / 2^k of p.
Polynomial deflated(const Polynomial& p, Integer m, long k) {
  const long zeros = m == 0 ? k : std::min(k, static_cast<long>(mpz_scan1(raw(m), 0)));
  if (m == 0) return {p.begin() + 1, p.end()};
  if (zeros > 0) mpz_fdiv_q_2exp(raw(m), raw(m), bit_count(zeros));
  k -= std::max(zeros, 0L);
  if (k < 0) m = shifted(m, -k);
  const Polynomial linear{Integer(-m), shifted(Integer(1), std::max(k, 0L))};
  if (auto quotient = divide_exact(p, linear)) return *std::move(quotient);
  return *divide_exact(primitive(p), linear);
}

/// Bernstein coefficients on [0, 1] times lcm of the binomials. b_i = sum_k C(i,k) / C(n,k) c_k.
std::vector<Integer> to_bernstein(const Polynomial& p) {
  const auto n = static_cast<unsigned long>(degree(p));
  Integer lcm = 1;
  for (unsigned long i = 2; i <= n + 1; ++i) mpz_lcm_ui(raw(lcm), raw(lcm), i);
  Integer factor;
  mpz_divexact_ui(raw(factor), raw(lcm), n + 1);
  std::vector<Integer> b(p);
  for (unsigned long i = 0; i <= n; ++i) {
    b[i] *= factor;
    mpz_mul_ui(raw(factor), raw(factor), i + 1);
    if (i < n) mpz_divexact_ui(raw(factor), raw(factor), n - i);
  }
  for (std::size_t j = 1; j <= n; ++j)
    for (std::size_t i = n; i >= j; --i) mpz_add(raw(b[i]), raw(b[i]), raw(b[i - 1]));
  return b;
}

int variations(const std::vector<Integer>& b) {
  int count = 0;
  int last = 0;
  for (const auto& c : b) {
    const int s = sign(c);
    if (s == 0) continue;
    if (last != 0 && s != last) ++count;
    last = s;
  }
  return count;
}

/// The part (c, c + 1) / 2^k of the unit interval.
struct Cell {
  std::vector<Integer> b;
  Integer c = 0;
  long k = 0;
};

/// Halves a cell: `cell` becomes the left half, the right half is returned. Both get the factor 2^n.
Cell split(Cell& cell) {
  const std::size_t n = cell.b.size() - 1;
  Cell right{std::move(cell.b), 2 * cell.c + 1, cell.k + 1};
  cell.b.resize(n + 1);
  auto& b = right.b;
  for (std::size_t j = 0; j <= n; ++j) {
    mpz_mul_2exp(raw(cell.b[j]), raw(b[0]), n - j);
    for (std::size_t i = 0; i + j < n; ++i) mpz_add(raw(b[i]), raw(b[i]), raw(b[i + 1]));
  }
  for (std::size_t i = 0; i <= n; ++i) mpz_mul_2exp(raw(b[i]), raw(b[i]), i);
  cell.c *= 2;
  cell.k += 1;
  return right;
}

/// Isolating cells of the unit interval, left to right; `midpoint` is set to a split point that is a root,
/// and the cells are then worthless.
struct Isolation {
  std::vector<Cell> cells;
  std::optional<Cell> midpoint;
};

Isolation isolate(std::vector<Integer> bernstein) {
  Isolation result;
  std::vector<Cell> stack;
  stack.push_back({std::move(bernstein), 0, 0});
  while (!stack.empty()) {
    Cell cell = std::move(stack.back());
    stack.pop_back();
    const int count = variations(cell.b);
    if (count == 0) continue;
    if (count == 1) {
      result.cells.push_back(std::move(cell));
      continue;
    }
    Cell right = split(cell);
    if (sign(right.b[0]) == 0) {
      result.midpoint = std::move(right);
      return result;
    }
    stack.push_back(std::move(right));
    stack.push_back(std::move(cell));
  }
  return result;
}

Root exact_root(Integer m, long k) {
  Root root;
  root.p = std::make_shared<const Polynomial>();
  root.m = std::move(m);
  root.k = k;
  root.exact = true;
  return root;
}

/// Value order of two roots of one polynomial whose intervals do not overlap.
bool before(const Root& a, const Root& b) {
  const long k = std::max(a.k, b.k);
  const Integer left = shifted(a.m, k - a.k);
  const Integer right = shifted(b.m, k - b.k);
  if (left != right) return left < right;
  return a.exact && !b.exact;
}

/// Roots of a square-free p in the open interval (0, 1) where p(0) and p(1) are not zero.
void open_unit_roots(Polynomial p, std::vector<Root>& roots) {
  while (degree(p) > 0) {
    const Isolation found = isolate(to_bernstein(p));
    if (found.midpoint) {
      roots.push_back(exact_root(found.midpoint->c, found.midpoint->k));
      p = deflated(p, found.midpoint->c, found.midpoint->k);
      continue;
    }
    const auto shared = std::make_shared<const Polynomial>(std::move(p));
    for (const auto& cell : found.cells)
      roots.push_back({shared, cell.c, cell.k, false, sign(cell.b.front()), 1});
    return;
  }
}

/// Bound b with all roots below 2^b in magnitude (Fujiwara 1916).
long root_bound_bits(const Polynomial& p) {
  const long n = degree(p);
  const long top = bits(p.back());
  std::optional<long> best;
  for (long j = 1; j <= n; ++j) {
    const Integer& c = p[static_cast<std::size_t>(n - j)];
    if (sign(c) == 0) continue;
    const long ratio = bits(c) - top + 1;
    const long rounded = ratio >= 0 ? (ratio + j - 1) / j : -((-ratio) / j);
    if (!best || rounded > *best) best = rounded;
  }
  return best.value_or(0) + 1;
}

/// p((lo + (hi - lo) u) / 2^k) 2^(k n) as polynomial in u.
Polynomial on_interval(const Polynomial& p, const Integer& lo, const Integer& hi, long k) {
  Polynomial q = p;
  const long n = degree(p);
  for (long i = 0; i <= n; ++i) {
    auto& c = q[static_cast<std::size_t>(i)];
    c = k >= 0 ? shifted(c, k * (n - i)) : shifted(c, -k * i);
  }
  q = taylor_shift(std::move(q), lo);
  Integer factor = 1;
  for (auto& c : q) {
    c *= factor;
    factor *= hi - lo;
  }
  return q;
}

/// p on (2^a, 2^b) in Bernstein form.
std::vector<Integer> bernstein_between_powers(const Polynomial& p, long a, long b) {
  return to_bernstein(on_interval(p, 1, shifted(Integer(1), b - a), -a));
}

/// Positive roots of a square-free p with p(0) != 0: parted by powers of two, then bisected.
class PositiveRoots {
 public:
  explicit PositiveRoots(Polynomial p) {
    while (degree(p) > 0) {
      p_ = std::make_shared<const Polynomial>(std::move(p));
      Polynomial reversed(p_->rbegin(), p_->rend());
      const std::size_t kept = roots_.size();
      // 2^a and 2^b are strictly outside, one step more than the bounds.
      if (part(-root_bound_bits(reversed) - 1, root_bound_bits(*p_) + 1)) break;
      roots_.resize(kept);
      roots_.push_back(exact_root(hit_.m, hit_.k));
      p = deflated(*p_, hit_.m, hit_.k);
    }
  }
  std::vector<Root> take() { return std::move(roots_); }

 private:
  /// Roots in (2^a, 2^b), whose ends are no roots. False: `hit_` is a root met on the way.
  bool part(long a, long b) {
    std::vector<Integer> bernstein = bernstein_between_powers(*p_, a, b);
    const int count = variations(bernstein);
    if (count == 0) return true;
    if (count == 1) return narrow(a, b);
    if (b - a == 1) return bisect(std::move(bernstein), a);
    const long mid = a + (b - a) / 2;
    if (sign(value_at(*p_, 1, -mid)) == 0) return meet(1, -mid);
    return part(a, mid) && part(mid, b);
  }
  bool meet(const Integer& m, long k) {
    hit_ = exact_root(m, k);
    return false;
  }
  bool narrow(long a, long b) {
    const int left = sign(value_at(*p_, 1, -a));
    while (b - a > 1) {
      const long mid = a + (b - a) / 2;
      const int s = sign(value_at(*p_, 1, -mid));
      if (s == 0) return meet(1, -mid);
      (s == left ? a : b) = mid;
    }
    roots_.push_back({p_, 1, -a, false, left, 1});
    return true;
  }
  bool bisect(std::vector<Integer> bernstein, long a) {
    const Isolation found = isolate(std::move(bernstein));
    const auto place = [a](const Cell& cell) {
      return std::pair{shifted(Integer(1), cell.k) + cell.c, cell.k - a};
    };
    if (found.midpoint) return meet(place(*found.midpoint).first, place(*found.midpoint).second);
    for (const auto& cell : found.cells)
      roots_.push_back({p_, place(cell).first, place(cell).second, false, sign(cell.b.front()), 1});
    return true;
  }

  std::shared_ptr<const Polynomial> p_;
  std::vector<Root> roots_;
  Root hit_;
};

Polynomial mirrored(Polynomial p) {
  for (std::size_t i = 1; i < p.size(); i += 2) p[i] = -p[i];
  return p;
}

/// The root at -x of p(-x): the interval turns round.
Root mirrored(Root root) {
  root.m = root.exact ? Integer(-root.m) : Integer(-root.m - 1);
  root.left_sign = -root.left_sign;
  root.p = std::make_shared<const Polynomial>(mirrored(*root.p));
  return root;
}

/// Sorts and makes intervals of different polynomials disjoint. Distinct roots, so it ends.
void sort_disjoint(std::vector<Root>& roots) {
  const auto overlap = [](const Root& a, const Root& b) {
    const long k = std::max(a.k, b.k);
    const Integer a_lo = shifted(a.m, k - a.k);
    const Integer b_lo = shifted(b.m, k - b.k);
    const Integer a_hi = a.exact ? a_lo : Integer(a_lo + shifted(Integer(1), k - a.k));
    const Integer b_hi = b.exact ? b_lo : Integer(b_lo + shifted(Integer(1), k - b.k));
    return a_lo < b_hi && b_lo < a_hi;
  };
  for (std::size_t i = 0; i < roots.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      while (overlap(roots[i], roots[j])) {
        const long k = std::max(roots[i].k, roots[j].k) + 1;
        refine(roots[i], k);
        refine(roots[j], k);
      }
    }
  }
  std::sort(roots.begin(), roots.end(), before);
}

/// Numerator and radius of f over the root's interval, scaled by 2^(k deg f): f(t) 2^(k deg f) is within
/// `radius` of `value`.
struct Image {
  Integer value, radius;
};
Image image_of(const Root& root, const Polynomial& f, const Integer& lipschitz) {
  const long d = std::max(degree(f), 0L);
  return {value_at(f, root.m, root.k),
          root.exact || d == 0 ? Integer(0) : shifted(lipschitz, root.k * (d - 1))};
}

}  // namespace

long bits(const Integer& a) { return sign(a) == 0 ? 0 : static_cast<long>(mpz_sizeinbase(raw(a), 2)); }

Integer shifted(const Integer& a, long k) {
  Integer result;
  mpz_mul_2exp(raw(result), raw(a), bit_count(k));
  return result;
}

Dyadic exact(double x) {
  if (x == 0) return {};
  // 53 bits make the significand of a double an integer; its trailing zeros are stripped.
  int e = 0;
  auto m = static_cast<std::int64_t>(std::ldexp(std::frexp(x, &e), 53));
  e -= 53;
  const int zeros = __builtin_ctzll(static_cast<unsigned long long>(m));
  return {m / (std::int64_t{1} << zeros), static_cast<long>(e) + zeros};
}

void trim(Polynomial& p) {
  while (!p.empty() && sign(p.back()) == 0) p.pop_back();
}

Polynomial add(const Polynomial& a, const Polynomial& b) {
  Polynomial sum = a.size() >= b.size() ? a : b;
  const Polynomial& other = a.size() >= b.size() ? b : a;
  for (std::size_t i = 0; i < other.size(); ++i) sum[i] += other[i];
  trim(sum);
  return sum;
}

Polynomial multiply(const Polynomial& a, const Polynomial& b) {
  if (a.empty() || b.empty()) return {};
  Polynomial product(a.size() + b.size() - 1);
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j) mpz_addmul(raw(product[i + j]), raw(a[i]), raw(b[j]));
  return product;
}

Polynomial scaled(const Polynomial& p, const Integer& factor) {
  Polynomial result = p;
  for (auto& c : result) c *= factor;
  trim(result);
  return result;
}

Polynomial derivative(const Polynomial& p) {
  Polynomial d;
  for (std::size_t i = 1; i < p.size(); ++i) d.push_back(p[i] * i);
  return d;
}

Polynomial taylor_shift(Polynomial p, const Integer& a) {
  const std::size_t n = p.size();
  for (std::size_t j = 0; j + 1 < n; ++j)
    for (std::size_t i = n - 1; i-- > j;) mpz_addmul(raw(p[i]), raw(p[i + 1]), raw(a));
  return p;
}

Integer value_at(const Polynomial& p, const Integer& m, long k) {
  if (p.empty()) return 0;
  if (k < 0) return value_at(p, shifted(m, -k), 0);
  Integer value = p.back();
  Integer term;
  long shift = 0;
  for (std::size_t i = p.size() - 1; i-- > 0;) {
    mpz_mul(raw(value), raw(value), raw(m));
    shift += k;
    mpz_mul_2exp(raw(term), raw(p[i]), bit_count(shift));
    mpz_add(raw(value), raw(value), raw(term));
  }
  return value;
}

std::optional<Polynomial> divide_exact(const Polynomial& p, const Polynomial& b) {
  if (p.size() < b.size()) return p.empty() ? std::optional<Polynomial>(p) : std::nullopt;
  Polynomial rest = p;
  Polynomial quotient(p.size() - b.size() + 1);
  for (std::size_t i = quotient.size(); i-- > 0;) {
    const Integer& top = rest[i + b.size() - 1];
    if (mpz_divisible_p(raw(top), raw(b.back())) == 0) return std::nullopt;
    mpz_divexact(raw(quotient[i]), raw(top), raw(b.back()));
    for (std::size_t j = 0; j < b.size(); ++j) mpz_submul(raw(rest[i + j]), raw(quotient[i]), raw(b[j]));
  }
  trim(rest);
  if (!rest.empty()) return std::nullopt;
  return quotient;
}

Polynomial primitive(Polynomial p) {
  if (p.empty()) return p;
  Integer content = 0;
  for (const auto& c : p) mpz_gcd(raw(content), raw(content), raw(c));
  if (sign(p.back()) < 0) content = -content;
  if (content == 1) return p;
  for (auto& c : p) mpz_divexact(raw(c), raw(c), raw(content));
  return p;
}

Polynomial gcd(const Polynomial& a, const Polynomial& b) {
  if (a.empty() || b.empty()) return primitive(a.empty() ? b : a);
  if (degree(a) == 0 || degree(b) == 0) return {1};
  const Polynomial first = primitive(a);
  const Polynomial second = primitive(b);
  const Integer lead = boost::multiprecision::gcd(first.back(), second.back());
  ChineseRemainder joined;
  long best = std::min(degree(first), degree(second)) + 1;
  std::uint64_t joined_primes = 0;
  for (std::uint64_t p = kMersenne61;; p = next_prime(p)) {
    const Field field{p};
    if (field.of(first.back()) == 0 || field.of(second.back()) == 0) continue;
    Residues g = gcd(residues(first, field), residues(second, field), field);
    const auto d = static_cast<long>(g.size()) - 1;
    if (d == 0) return {1};
    if (d > best) continue;
    if (d < best) {
      joined.restart();
      joined_primes = 0;
    }
    best = d;
    const std::uint64_t factor = field.mul(field.of(lead), field.inverse(g.back()));
    for (auto& c : g) c = field.mul(c, factor);
    joined.join(g, field);
    // A candidate is tried whenever the number of primes has doubled: the proof by division costs more than a
    // prime.
    if (!std::has_single_bit(++joined_primes)) continue;
    Polynomial candidate = primitive(joined.symmetric());
    if (divide_exact(first, candidate) && divide_exact(second, candidate)) return candidate;
  }
}

std::vector<std::pair<Polynomial, std::uint32_t>> square_free(const Polynomial& p) {
  if (degree(p) < 1) return {};
  const Polynomial slope = derivative(p);
  // The leading coefficient survives modulo the prime, so a constant gcd there is a constant gcd.
  const Field field{kMersenne61};
  if (field.of(p.back()) != 0 && gcd(residues(p, field), residues(slope, field), field).size() == 1)
    return {{p, 1}};
  std::vector<std::pair<Polynomial, std::uint32_t>> factors;
  const Polynomial common = gcd(p, slope);
  Polynomial b = *divide_exact(p, common);
  Polynomial d = add(*divide_exact(slope, common), scaled(derivative(b), -1));
  for (std::uint32_t i = 1; degree(b) > 0; ++i) {
    const Polynomial factor = gcd(b, d);
    if (degree(factor) > 0) factors.emplace_back(factor, i);
    b = *divide_exact(b, factor);
    d = add(*divide_exact(d, factor), scaled(derivative(b), -1));
  }
  return factors;
}

Polynomial image_resultant(const Polynomial& p, const Polynomial& f) {
  // Hadamard's bound with row sums: the sum of the magnitudes of all coefficients is below it.
  const long bound = degree(f) * bits(norm1(p)) + degree(p) * bits(norm1(f) + 1) + 2;
  ChineseRemainder joined;
  for (std::uint64_t prime = kMersenne61; bits(joined.modulus()) <= bound; prime = next_prime(prime)) {
    const Field field{prime};
    if (field.of(p.back()) == 0 || field.of(f.back()) == 0) continue;
    const Residues a = residues(p, field);
    Residues values(p.size());
    for (std::size_t w = 0; w < values.size(); ++w) {
      Residues b = residues(f, field);
      for (auto& c : b) c = field.sub(0, c);
      b[0] = field.add(b[0], w);
      values[w] = resultant(a, b, field);
    }
    joined.join(interpolate(values, field), field);
  }
  return joined.symmetric();
}

std::vector<Root> roots_in_unit_interval(const Polynomial& p) {
  std::vector<Root> roots;
  Polynomial q = p;
  const auto strip = [&roots, &q](const Integer& end) {
    const std::size_t before_stripping = q.size();
    while (sign(value_at(q, end, 0)) == 0) q = deflated(q, end, 0);
    if (q.size() == before_stripping) return;
    roots.push_back(exact_root(end, 0));
    roots.back().multiplicity = static_cast<std::uint32_t>(before_stripping - q.size());
  };
  strip(0);
  strip(1);
  if (degree(q) < 1) return roots;
  // Descartes counts with multiplicity: no variation is no root, one is a simple root, both without a gcd.
  const std::vector<Integer> bernstein = to_bernstein(q);
  const int count = variations(bernstein);
  if (count == 1)
    roots.push_back({std::make_shared<const Polynomial>(q), 0, 0, false, sign(bernstein.front()), 1});
  if (count > 1) {
    for (const auto& [factor, multiplicity] : square_free(q)) {
      const std::size_t first = roots.size();
      open_unit_roots(factor, roots);
      for (std::size_t i = first; i < roots.size(); ++i) roots[i].multiplicity = multiplicity;
    }
  }
  sort_disjoint(roots);
  return roots;
}

std::vector<Root> all_real_roots(const Polynomial& p) {
  std::vector<Root> roots;
  std::size_t zeros = 0;
  while (sign(p[zeros]) == 0) ++zeros;
  if (zeros > 0) {
    roots.push_back(exact_root(0, 0));
    roots.back().multiplicity = static_cast<std::uint32_t>(zeros);
  }
  const Polynomial q(p.begin() + static_cast<std::ptrdiff_t>(zeros), p.end());
  for (const auto& [factor, multiplicity] : square_free(q)) {
    const std::size_t first = roots.size();
    for (auto& root : PositiveRoots(factor).take()) roots.push_back(std::move(root));
    for (auto& root : PositiveRoots(mirrored(factor)).take()) roots.push_back(mirrored(std::move(root)));
    for (std::size_t i = first; i < roots.size(); ++i) roots[i].multiplicity = multiplicity;
  }
  sort_disjoint(roots);
  return roots;
}

void refine(Root& root, long k) {
  if (root.exact || root.k >= k) return;
  Integer left = value_at(*root.p, root.m, root.k);
  Integer right = value_at(*root.p, root.m + 1, root.k);
  const auto found_exact = [&root](const Integer& m, long at) {
    root.m = m;
    root.k = at;
    root.exact = true;
  };
  while (root.k < k) {
    // The secant through both ends picks the grid point next to the root; one bit has only the midpoint.
    const long step = std::min(root.step, k - root.k);
    const long finer = root.k + step;
    const Integer size = abs(left) + abs(right);
    const Integer guess = step == 1 ? Integer(1) : (shifted(abs(left), step + 1) + size) / (2 * size);
    const Integer first = shifted(root.m, step) + guess;
    Integer at_first = value_at(*root.p, first, finer);
    if (sign(at_first) == 0) return found_exact(first, finer);
    const bool root_is_right = sign(at_first) == root.left_sign;
    const Integer second = root_is_right ? Integer(first + 1) : Integer(first - 1);
    Integer at_second = value_at(*root.p, second, finer);
    if (sign(at_second) == 0) return found_exact(second, finer);
    if (sign(at_second) == sign(at_first)) {
      root.step = std::max(1L, step / 2);
      continue;
    }
    root.m = root_is_right ? first : second;
    root.k = finer;
    if (!root_is_right) std::swap(at_first, at_second);
    left = std::move(at_first);
    right = std::move(at_second);
    root.step = std::max(root.step, 2 * step);
  }
}

bool vanishes_at(const Root& root, const Polynomial& f) {
  if (f.empty()) return true;
  if (root.exact) return sign(value_at(f, root.m, root.k)) == 0;
  // The common divisor divides *p: no zero at the ends, at most a simple one inside.
  const Polynomial common = gcd(*root.p, f);
  if (degree(common) < 1) return false;
  return sign(value_at(common, root.m, root.k)) != sign(value_at(common, root.m + 1, root.k));
}

Integer lipschitz_bound(const Polynomial& f) {
  Integer bound = 0;
  for (std::size_t i = 1; i < f.size(); ++i) bound += abs(f[i]) * i;
  return bound;
}

int sign_at(Root& root, const Polynomial& f) {
  if (f.empty()) return 0;
  // 32 bits settle most signs; equality is asked for only once, past 128 bits.
  constexpr long kFirst = 32;
  constexpr long kDoubt = 128;
  const Integer lipschitz = lipschitz_bound(f);
  for (long k = kFirst;; k *= 2) {
    refine(root, k);
    const Image image = image_of(root, f, lipschitz);
    if (abs(image.value) > image.radius) return sign(image.value);
    if (root.exact) return 0;
    if (k == kDoubt && vanishes_at(root, f)) return 0;
  }
}

bool equal_images(Root& a, Root& b, const Polynomial& f) {
  if (b.exact && !a.exact) return equal_images(b, a, f);
  const long d = degree(f);
  if (d < 1) return true;
  if (a.exact) {
    const long k = std::max(a.k, 0L);
    Polynomial difference = scaled(f, shifted(Integer(1), k * d));
    difference[0] -= value_at(f, a.m, a.k);
    return vanishes_at(b, difference);
  }
  const Polynomial resultant = image_resultant(a.p == b.p ? *a.p : multiply(*a.p, *b.p), f);
  const Polynomial simple = *divide_exact(primitive(resultant), gcd(resultant, derivative(resultant)));
  const Integer lipschitz = lipschitz_bound(f);
  // The interval must hold one root of the resultant; 128 bits part all but the closest.
  for (long k = 128;; k *= 2) {
    refine(a, k);
    refine(b, k);
    if (a.exact || b.exact) return equal_images(a, b, f);
    const long common = std::max(a.k, b.k);
    refine(a, common);
    refine(b, common);
    if (a.exact || b.exact || a.k != b.k) continue;
    const Image first = image_of(a, f, lipschitz);
    const Image second = image_of(b, f, lipschitz);
    const Integer lo = std::min(first.value, second.value) - first.radius;
    const Integer hi = std::max(first.value, second.value) + first.radius;
    if (abs(first.value - second.value) > 2 * first.radius) return false;
    if (variations(to_bernstein(on_interval(simple, lo, hi, a.k * d))) == 1) return true;
  }
}

bool takes_positive_value(const Polynomial& f) {
  if (f.empty()) return false;
  if (sign(value_at(f, 0, 0)) > 0 || sign(value_at(f, 1, 0)) > 0) return true;
  // Between its roots f keeps one sign, so one point in each gap is enough. The cells are disjoint; one step
  // finer they do not touch either, unless the root is a point.
  std::vector<Root> roots = roots_in_unit_interval(f);
  for (std::size_t i = 0; i + 1 < roots.size(); ++i) {
    Root& left = roots[i];
    Root& right = roots[i + 1];
    while (true) {
      const long k = std::max(left.k, right.k) + 1;
      const Integer gap_lo = shifted(left.exact ? left.m : Integer(left.m + 1), k - left.k);
      const Integer gap_hi = shifted(right.m, k - right.k);
      if (gap_lo < gap_hi) {
        if (sign(value_at(f, (gap_lo + gap_hi) / 2, k)) > 0) return true;
        break;
      }
      refine(left, k);
      refine(right, k);
    }
  }
  return false;
}

}  // namespace graze::truth
