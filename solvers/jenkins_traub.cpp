#include <graze/solvers/jenkins_traub.hpp>

#include <array>
#include <optional>
#include <utility>

#include <graze/solvers/math/complex_roots.hpp>

namespace graze {
namespace {

using complex_roots::Complex;
using complex_roots::magnitude;
using power_basis::Coefficients;
using power_basis::Problem;

/// Limits of Algorithm 493.
constexpr int kNoShiftSteps = 5;     // stage 1
constexpr int kFixedSteps = 20;      // stage 2, for the first shift; k times as many for the k-th
constexpr int kRealSteps = 10;       // stage 3, linear
constexpr int kQuadraticSteps = 20;  // stage 3, quadratic
constexpr double kPass = 0.25;       // two estimates that agree like this (as a product) start stage 3
constexpr double kGuard = 20;        // |p| below this many error bounds is a zero

/// sigma(x) = x^2 + u x + v.
template <class T>
struct Quadratic {
  T u = 0, v = 0;
};

/// Remainder b (x + u) + a modulo sigma.
template <class T>
struct Remainder {
  T a = 0, b = 0;
};

/// f / sigma into `quotient` (two shorter than f) and what remains.
template <class T>
Remainder<T> divide(Coefficients<T> f, Quadratic<T> sigma, std::span<T> quotient) {
  T above = 0, here = 0;
  for (std::size_t i = f.size(); i-- > 0;) {
    const T next = f[i] - sigma.u * here - sigma.v * above;
    above = here;
    here = next;
    if (i >= 2) quotient[i - 2] = here;
  }
  return {here, above};
}

/// f / (x - s) into `quotient` (one shorter than f); value f(s) and a bound on its rounding.
template <class T>
std::pair<T, T> divide(Coefficients<T> f, T s, std::span<T> quotient) {
  T here = f.back(), bound = 0;
  for (std::size_t i = f.size() - 1; i-- > 0;) {
    quotient[i] = here;
    bound = std::fabs(s) * (bound + std::fabs(here));
    here = f[i] + s * here;
    bound += std::fabs(here);
  }
  return {here, power_basis::kU<T> * bound};
}

/// One zero or two: the real and the imaginary parts.
template <class T>
struct Found {
  int count = 0;
  std::array<T, 2> real{}, imag{};

  [[nodiscard]] Complex<T> zero(int i) const {
    return {real[static_cast<std::size_t>(i)], imag[static_cast<std::size_t>(i)]};
  }
};

/// The zeros of a2 x^2 + a1 x + a0, the larger real one first; conjugates the one above the axis first.
template <class T>
Found<T> quadratic_zeros(T a0, T a1, T a2) {
  const T half = -a1 / 2;
  // Kahan's difference of products: h^2 - a0 a2 with a relative error of 2u.
  const T w = a0 * a2, d = std::fma(half, half, -w) - std::fma(a0, a2, -w);
  if (d < 0) {
    const T imag = std::fabs(std::sqrt(-d) / a2);
    return {2, {half / a2, half / a2}, {imag, -imag}};
  }
  const T q = half + std::copysign(std::sqrt(d), half);
  return {2, {q / a2, q == 0 ? T{0} : a0 / q}, {}};
}

/// The search for one zero or pair of p, degree n >= 3. K has degree n - 1.
template <class T>
class Search {
 public:
  Search(std::span<T> p, Counters& counters)
      : p_(p),
        k_memory_(p.size() - 1),
        saved_memory_(p.size() - 1),
        quotient_memory_(p.size()),
        k_quotient_memory_(p.size()),
        counters_(counters) {}

  /// The three stages; on success the quotient holds p without the zeros found.
  Found<T> run() {
    no_shift();
    Scratch first(k().size());
    std::copy(k().begin(), k().end(), first.span().begin());
    const T radius = least_magnitude();
    for (int shift = 1; shift <= JenkinsTraub::kShifts; ++shift) {
      // 49 degrees, then 94 further on each time: never near a multiple of a former one (Algorithm 493).
      constexpr T kDegree = std::numbers::pi_v<T> / 180;
      const T angle = kDegree * static_cast<T>(49 + 94 * (shift - 1));
      std::copy(first.span().begin(), first.span().end(), k().begin());
      const Found<T> found =
          fixed_shift({-2 * radius * std::cos(angle), radius * radius}, kFixedSteps * shift);
      if (found.count > 0) return found;
    }
    return {};
  }
  [[nodiscard]] std::span<const T> quotient(int zeros) {
    return quotient_memory_.span().first(p_.size() - static_cast<std::size_t>(zeros));
  }

 private:
  using Scratch = power_basis::Scratch<T>;
  std::span<T> k() { return k_memory_.span(); }

  /// Powers of two keep K's largest coefficient in [1, 2); false: K has vanished.
  bool rescale() {
    T largest = 0;
    for (const T v : k()) largest = std::max(largest, std::fabs(v));
    if (!(largest > 0) || !std::isfinite(largest)) return false;
    const int power = std::ilogb(largest);
    for (T& v : k()) v = std::ldexp(v, -power);
    ++counters_.iterations;
    return true;
  }

  /// Stage 1: K = p', then K <- (K - K(0)/p(0) p) / x, which brings out the small zeros.
  void no_shift() {
    const std::size_t n = p_.size() - 1;
    for (std::size_t i = 0; i < n; ++i) k()[i] = static_cast<T>(i + 1) * p_[i + 1];
    for (int step = 0; step < kNoShiftSteps && rescale(); ++step) {
      const T ratio = k()[0] / p_[0];
      for (std::size_t i = 0; i < n; ++i) k()[i] = (i + 1 < n ? k()[i + 1] : T{0}) - ratio * p_[i + 1];
    }
    rescale();
  }

  /// Cauchy's lower bound on the zeros' magnitudes: the positive zero of sum_{i>0} |c_i| x^i - |c_0|, by
  /// Newton from above to two digits, which is all that a shift needs.
  T least_magnitude() {
    const std::size_t n = p_.size() - 1;
    T x = std::numeric_limits<T>::infinity();
    for (std::size_t i = 1; i <= n; ++i) {
      if (p_[i] == 0) continue;
      const T height = std::log2(std::fabs(p_[0])) - std::log2(std::fabs(p_[i]));
      x = std::min(x, std::exp2(height / static_cast<T>(i)));
    }
    constexpr int kSteps = 40;  // x is at most n times too large: each step takes it down by 1 - 1/n or more
    for (int step = 0; step < kSteps; ++step) {
      T value = 0, slope = 0;
      for (std::size_t i = n + 1; i-- > 0;) {
        slope = slope * x + value;
        value = value * x + (i == 0 ? -std::fabs(p_[i]) : std::fabs(p_[i]));
      }
      const T dx = value / slope;
      x -= dx;
      if (!(std::fabs(dx) > static_cast<T>(0.005) * x)) break;
    }
    return x;
  }

  /// K <- (K - (A + B x) p) / sigma with A + B x = K / p modulo sigma, times the norm of p modulo sigma;
  /// `rest` is p's remainder, the quotient of p by sigma is in place.
  bool quadratic_step(Quadratic<T> sigma, Remainder<T> rest) {
    const std::span<T> q = quotient_memory_.span(), qk = k_quotient_memory_.span();
    const auto [a, b] = rest;
    const auto [c, d] = divide<T>(k(), sigma, qk);
    const T norm = a * a + sigma.u * a * b + sigma.v * b * b;
    const T A = a * c + sigma.u * a * d + sigma.v * b * d, B = a * d - b * c;
    const std::size_t n = p_.size() - 1;
    for (std::size_t i = 0; i < n; ++i) {
      const T from_k = i + 2 < n ? norm * qk[i] : T{0};
      const T from_p = (i + 1 < n ? A * q[i] : T{0}) + (i > 0 ? B * q[i - 1] : B * b);
      k()[i] = from_k - from_p;
    }
    return rescale();
  }

  /// sigma whose zeros K, K_1 and K_2 (K after one and two steps without shift) agree on: modulo the old
  /// sigma, v K_2 + u K_1 + K = 0, two linear equations. For the old u and v the left side is
  /// p (ratio_1 (x + u) + ratio_0), which is small with p: the change of u and v is solved for, not u and v,
  /// so that near a pair of close zeros no digits are lost.
  std::optional<Quadratic<T>> next_sigma(Quadratic<T> sigma, Remainder<T> rest) {
    const auto [c, d] = divide<T>(k(), sigma, k_quotient_memory_.span());
    struct Line {
      T e, f;  // e + f x
    };
    const auto [a, b] = rest;
    const T u = sigma.u, v = sigma.v;
    const Line p{a + b * u, b};
    // (K - ratio p) / x modulo sigma, where 1 / x = -(x + u) / v.
    const auto unshifted = [&](Line line, T ratio) {
      const T e = line.e - ratio * p.e, f = line.f - ratio * p.f;
      return Line{f - e * (u / v), -e / v};
    };
    const T ratio_0 = k()[0] / p_[0], ratio_1 = (k()[1] - ratio_0 * p_[1]) / p_[0];
    const Line k1 = unshifted({c + d * u, d}, ratio_0), k2 = unshifted(k1, ratio_1);
    const Line left{p.e * (ratio_0 + ratio_1 * u) - b * ratio_1 * v,
                    a * ratio_1 + b * (ratio_0 + ratio_1 * u)};
    const T det = k2.e * k1.f - k1.e * k2.f;
    const Quadratic<T> next{u + (k2.f * left.e - k2.e * left.f) / det,
                            v + (k1.e * left.f - k1.f * left.e) / det};
    if (!std::isfinite(next.u) || !std::isfinite(next.v) || next.v == 0) return std::nullopt;
    return next;
  }

  /// How well a sequence of estimates settles: the product of its last two relative changes while they
  /// shrink, else 1.
  struct Trend {
    T last = 0, change = 1;
    bool begun = false;
    T add(T value) {
      const T now = begun && value != 0 ? std::fabs((value - last) / value) : T{1};
      const T score = now < change ? now * change : T{1};
      last = value;
      change = now;
      begun = true;
      return score;
    }
  };

  /// Stage 2: K converges under the fixed sigma until its estimates of sigma or of a real zero settle.
  Found<T> fixed_shift(Quadratic<T> sigma, int steps) {
    Trend v_trend, s_trend;
    T v_pass = static_cast<T>(kPass), s_pass = static_cast<T>(kPass);
    Remainder<T> rest = divide<T>(p_, sigma, quotient_memory_.span());
    ++counters_.evaluations;
    for (int step = 0; step < steps; ++step) {
      if (!quadratic_step(sigma, rest)) return {};
      const std::optional<Quadratic<T>> estimate = next_sigma(sigma, rest);
      const T s = k()[0] == 0 ? T{0} : -p_[0] * (k().back() / p_.back()) / k()[0];
      const T v_score = v_trend.add(estimate ? estimate->v : T{0}), s_score = s_trend.add(s);
      const bool try_v = estimate && v_score < v_pass, try_s = s != 0 && s_score < s_pass;
      if (!try_v && !try_s) continue;
      const Found<T> found =
          variable_shift(try_v ? estimate : std::nullopt, try_s ? std::optional(s) : std::nullopt,
                         try_s && (!try_v || s_score < v_score));
      if (found.count > 0) return found;
      // Not yet: ask for more agreement next time.
      if (try_v) v_pass *= static_cast<T>(kPass);
      if (try_s) s_pass *= static_cast<T>(kPass);
      rest = divide<T>(p_, sigma, quotient_memory_.span());
      ++counters_.evaluations;
    }
    return {};
  }

  /// Stage 3 by whichever settled better first, then by the other; K comes back as it was on failure.
  Found<T> variable_shift(std::optional<Quadratic<T>> sigma, std::optional<T> s, bool real_first) {
    std::copy(k().begin(), k().end(), saved_memory_.span().begin());
    const auto restore = [this] {
      const std::span<T> saved = saved_memory_.span();
      std::copy(saved.begin(), saved.end(), k().begin());
    };
    for (const bool real : {real_first, !real_first}) {
      Found<T> found;
      if (real && s) found = real_iteration(*s);
      if (!real && sigma) found = quadratic_iteration(*sigma);
      if (found.count > 0) return found;
      restore();
    }
    return {};
  }

  /// Linear variable shift: K <- (K - K(s)/p(s) p) / (x - s), s <- s - p(s) / K(s) with K's leading
  /// coefficient that of p. A step that is small while |p| grows speaks of two zeros nearby: a pair is tried.
  Found<T> real_iteration(T s) {
    const std::span<T> q = quotient_memory_.span(), qk = k_quotient_memory_.span();
    T before = 0, ds = 0;
    for (int step = 0; step <= kRealSteps; ++step) {
      const auto [value, bound] = divide<T>(p_, s, q);
      ++counters_.evaluations;
      const T size = std::fabs(value);
      if (!std::isfinite(size)) return {};
      const bool at_rest = step > 0 && std::fabs(ds) <= power_basis::kU<T> * std::fabs(s);
      if (size <= static_cast<T>(kGuard) * bound || at_rest) return {1, {s}, {}};
      constexpr T kSmallStep = static_cast<T>(0.001);  // Algorithm 493
      if (step >= 2 && std::fabs(ds) <= kSmallStep * std::fabs(s - ds) && size > before) {
        return quadratic_iteration({-2 * s, s * s});
      }
      before = size;
      const T k_value = divide<T>(k(), s, qk).first;
      for (std::size_t i = 0; i < k().size(); ++i) {
        k()[i] = (i + 1 < k().size() ? value * qk[i] : T{0}) - k_value * q[i];
      }
      if (!rescale()) return {};
      const T k_next = divide<T>(k(), s, qk).first;
      ds = -value * (k().back() / p_.back()) / k_next;
      if (!std::isfinite(ds)) return {};
      s += ds;
    }
    return {};
  }

  /// Are all of sigma's zeros p's, to within kGuard times the rounding of p?
  bool are_zeros(const Found<T>& zeros) {
    const auto is_zero = [this](Complex<T> x) {
      const auto value = complex_roots::evaluate_scaled<false, T>(p_, x);
      ++counters_.evaluations;
      return magnitude(value.value) <= static_cast<T>(kGuard) * value.error;
    };
    return is_zero(zeros.zero(0)) && (zeros.imag[0] != 0 || is_zero(zeros.zero(1)));
  }

  /// Quadratic variable shift. It gives up where sigma's zeros are real and differ in size: those are for
  /// the linear one. Where sigma comes to rest off a zero (a cluster), it is moved once and K renewed.
  Found<T> quadratic_iteration(Quadratic<T> sigma) {
    constexpr T kApart = static_cast<T>(0.01), kStalled = static_cast<T>(0.01);  // Algorithm 493
    bool moved = false;
    T before = 0, change = 1;
    for (int step = 0; step < kQuadraticSteps; ++step) {
      const Found<T> zeros = quadratic_zeros<T>(sigma.v, sigma.u, 1);
      const T larger = magnitude(zeros.zero(0)), smaller = magnitude(zeros.zero(1));
      if (!(larger - smaller <= kApart * larger)) return {};
      Remainder<T> rest = divide<T>(p_, sigma, quotient_memory_.span());
      ++counters_.evaluations;
      if (are_zeros(zeros)) return zeros;
      const T size = std::fabs(rest.a) + std::fabs(rest.b) * larger;
      if (!moved && step > 1 && change <= kStalled && size >= before) {
        const T nudge = std::sqrt(std::max(change, std::numeric_limits<T>::epsilon()));
        sigma = {sigma.u - sigma.u * nudge, sigma.v + sigma.v * nudge};
        rest = divide<T>(p_, sigma, quotient_memory_.span());
        for (int i = 0; i < kNoShiftSteps; ++i) {
          if (!quadratic_step(sigma, rest)) return {};
        }
        moved = true;
      }
      before = size;
      if (!quadratic_step(sigma, rest)) return {};
      const std::optional<Quadratic<T>> next = next_sigma(sigma, rest);
      if (!next) return {};
      change = std::fabs((next->v - sigma.v) / next->v);
      sigma = *next;
    }
    return {};
  }

  std::span<T> p_;
  Scratch k_memory_, saved_memory_, quotient_memory_, k_quotient_memory_;
  Counters& counters_;
};

/// Files a zero; conjugates are filed by the one above the axis.
template <class T>
void file(const Problem<T>& problem, const Found<T>& zeros, bool polish, Roots& found) {
  for (int i = 0; i < zeros.count; ++i) {
    add_if_real(problem, zeros.zero(i), polish, found);
  }
}

/// Zero after zero, or pair after pair, divided off; false: budget.
template <class T>
bool find_all(const Problem<T>& problem, bool polish, std::span<T> left, Roots& found) {
  while (left.size() > 3) {
    ++found.counters.starts;
    Search<T> search(left, found.counters);
    const Found<T> zeros = search.run();
    if (zeros.count == 0) return false;
    file(problem, zeros, polish, found);
    const auto rest = search.quotient(zeros.count);
    std::copy(rest.begin(), rest.end(), left.begin());
    left = left.first(rest.size());
  }
  if (left.size() == 3) file(problem, quadratic_zeros(left[0], left[1], left[2]), polish, found);
  if (left.size() == 2) file(problem, Found<T>{1, {-left[0] / left[1]}, {}}, polish, found);
  return true;
}

}  // namespace

SolverInfo JenkinsTraub::info() {
  SolverInfo info;
  info.summary = "three-stage variable-shift algorithm for real polynomials";
  info.source = "Jenkins, Traub, SIAM J. Numer. Anal. 7 (1970); Jenkins, ACM TOMS 1 (1975)";
  info.page = "solvers/jenkins_traub.md";
  info.options = {{"polish", "true", "up to 3 Newton steps on each real root, on the polynomial as given"}};
  info.claims = {.finds_touching_roots = true, .certified = false, .deterministic = true};
  info.forms = {Form::polynomial};
  return info;
}

JenkinsTraub::JenkinsTraub(const Parameters& options) : polish_(options.flag("polish", true)) {}

template <class T>
void JenkinsTraub::solve(const BasicPolynomialEquation<T>& equation, Roots& roots) const {
  complex_roots::solve_scaled(equation, roots, [this](const Problem<T>& problem, Roots& found) {
    power_basis::Scratch<T> memory(problem.c.size());
    const std::span<T> left = memory.span();
    std::copy(problem.c.begin(), problem.c.end(), left.begin());
    if (!find_all(problem, polish_, left, found)) found.status = Status::failed;
  });
}

template void JenkinsTraub::solve(const BasicPolynomialEquation<double>&, Roots&) const;
template void JenkinsTraub::solve(const BasicPolynomialEquation<float>&, Roots&) const;

}  // namespace graze
