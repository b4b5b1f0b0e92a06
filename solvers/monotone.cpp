#include <graze/solvers/monotone.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include <graze/solvers/isolation.hpp>

namespace graze {
namespace {

using power_basis::Coefficients;
using power_basis::Problem;
using power_basis::Value;

/// A polynomial of degree N whose loops the compiler unrolls.
template <class T, std::size_t N>
struct Fixed {
  std::array<T, N + 1> c;

  [[nodiscard]] Value<T> operator()(T x) const {
    T p = c[N], d = 0;
    for (std::size_t i = N; i-- > 0;) {
      d = d * x + p;
      p = p * x + c[i];
    }
    return {p, d};
  }
  [[nodiscard]] T value(T x) const {
    T p = c[N];
    for (std::size_t i = N; i-- > 0;) p = p * x + c[i];
    return p;
  }
  [[nodiscard]] Coefficients<T> coefficients() const { return c; }
  [[nodiscard]] Fixed<T, N - 1> derivative() const {
    Fixed<T, N - 1> d;
    for (std::size_t i = 1; i <= N; ++i) d.c[i - 1] = static_cast<T>(i) * c[i];
    return d;
  }
};

/// The same for any degree.
template <class T>
struct Dynamic {
  Coefficients<T> c;

  [[nodiscard]] Value<T> operator()(T x) const { return power_basis::evaluate(c, x); }
  [[nodiscard]] T value(T x) const { return power_basis::evaluate(c, x).value; }
  [[nodiscard]] Coefficients<T> coefficients() const { return c; }
};

/// What one equation asks of every level of its cascade.
template <class T>
struct Search {
  T lo, hi;
  T absolute;  ///< the option `tolerance` times the width
  Roots& roots;

  template <class Polynomial>
  BracketRoot<T> root_between(const Polynomial& p, T a, T b, T at_a, BracketStop<T> stop) {
    const auto noise = [&p](T x) { return isolation::horner_noise(p.coefficients(), x); };
    const auto root = newton_in_bracket(p, noise, a, b, at_a < 0, stop);
    roots.counters.evaluations += root.steps;
    roots.counters.iterations += root.steps;
    if (!root.converged) roots.status = Status::failed;
    return root;
  }
};

/// lo, the critical points in ascending order, hi: `size` numbers in all.
template <class T>
struct Cuts {
  std::span<T> x;
  std::size_t size = 0;

  void add(T value) { x[size++] = value; }
  [[nodiscard]] std::span<const T> used() const { return x.first(size); }
};

/// An error d of a critical point changes p there by p'' d^2 / 2, and by p''' d^3 / 6 where p'' vanishes as
/// well: at d = u^(1/2) |x|, or u^(1/3) |x| where convergence is slow, that is rounding.
template <class T>
BracketStop<T> critical_point_stop(T absolute) {
  constexpr bool kDouble = std::numeric_limits<T>::digits == std::numeric_limits<double>::digits;
  return {kDouble ? T(0x1p-18) : T(0x1p-8), kDouble ? T(0x1p-27) : T(0x1p-12), absolute};
}

/// Writes lo, the roots of p and hi, given the cuts that p's own critical points make.
template <class T, class Polynomial>
void cut_at_roots(const Polynomial& p, const Cuts<T>& pieces, Cuts<T>& cuts, Search<T>& search) {
  T a = pieces.x[0];
  T at_a = p.value(a);
  search.roots.counters.evaluations += static_cast<std::uint32_t>(pieces.size);
  cuts.add(a);
  for (std::size_t i = 1; i < pieces.size; ++i) {
    const T b = pieces.x[i];
    const T at_b = p.value(b);
    if (at_a != 0 && at_b != 0 && (at_a < 0) != (at_b < 0))
      cuts.add(search.root_between(p, a, b, at_a, critical_point_stop(search.absolute)).x);
    if (at_b == 0) cuts.add(b);
    a = b;
    at_a = at_b;
  }
  cuts.add(a);
}

/// The bottom of the cascade: lo, the roots of c0 + c1 x + c2 x^2 between, hi. A pair that rounding makes
/// complex is a level above a point of inflection within rounding: no cut is needed.
template <class T>
void cut_at_quadratic_roots(Coefficients<T> c, Cuts<T>& cuts, const Search<T>& search) {
  cuts.add(search.lo);
  const T half = c[1] / 2;
  const T discriminant = half * half - c[2] * c[0];
  if (discriminant >= 0) {
    const T q = -(half + std::copysign(std::sqrt(discriminant), half));
    T x = q / c[2], y = q == 0 ? T{0} : c[0] / q;
    if (y < x) std::swap(x, y);
    if (x > search.lo && x < search.hi) cuts.add(x);
    if (y > search.lo && y < search.hi) cuts.add(y);
  }
  cuts.add(search.hi);
}

/// The bottom for an equation of degree 2.
template <class T>
void cut_at_linear_root(Coefficients<T> c, Cuts<T>& cuts, const Search<T>& search) {
  cuts.add(search.lo);
  const T x = -c[0] / c[1];
  if (x > search.lo && x < search.hi) cuts.add(x);
  cuts.add(search.hi);
}

/// lo, the roots of p, hi, for a derivative p of degree N, by the cuts of its own derivative.
template <class T, std::size_t N>
void cascade(const Fixed<T, N>& p, Cuts<T>& cuts, Search<T>& search) {
  if constexpr (N == 1) {
    cut_at_linear_root<T>(p.c, cuts, search);
  } else if constexpr (N == 2) {
    cut_at_quadratic_roots<T>(p.c, cuts, search);
  } else {
    std::array<T, N + 1> memory;
    Cuts<T> pieces{memory};
    cascade(p.derivative(), pieces, search);
    cut_at_roots(p, pieces, cuts, search);
  }
}

/// The same for any degree n: two lists of cuts that take turns, and coefficients made anew at each level,
/// p^(k) / k! by binomials, which one after the other are quotients of neighbours.
template <class T>
void cascade(Coefficients<T> c, Cuts<T>& cuts, Search<T>& search) {
  const std::size_t degree = c.size() - 1;
  power_basis::Scratch<T> level(c.size()), memory(c.size() + 1);
  for (std::size_t n = 2; n < degree; ++n) {
    const std::size_t order = degree - n;
    T binomial = 1;
    for (std::size_t i = 0; i <= n; ++i) {
      level.span()[i] = binomial * c[i + order];
      binomial = binomial * static_cast<T>(i + order + 1) / static_cast<T>(i + 1);
    }
    const Coefficients<T> p = level.span().first(n + 1);
    Cuts<T> pieces{memory.span(), cuts.size};
    std::copy_n(cuts.x.begin(), cuts.size, pieces.x.begin());
    cuts.size = 0;
    if (n == 2) {
      cut_at_quadratic_roots(p, cuts, search);
    } else {
      cut_at_roots(Dynamic<T>{p}, pieces, cuts, search);
    }
  }
}

/// The equation itself: a simple root in each piece whose ends have opposite signs, and what happens at the
/// critical points between.
template <class T, class Polynomial>
class LastLevel {
 public:
  LastLevel(const Polynomial& p, const Problem<T>& problem, std::span<const T> cuts, std::span<T> values,
            Search<T>& search)
      : p_(p), problem_(problem), cuts_(cuts), values_(values), search_(search) {
    for (std::size_t i = 0; i < cuts_.size(); ++i) values_[i] = p_.value(cuts_[i]);
    search_.roots.counters.evaluations += static_cast<std::uint32_t>(cuts_.size());
  }

  void run(bool touching) {
    for (std::size_t i = 1; i < cuts_.size(); ++i) {
      if (changes_sign(i)) add_simple(i);
      if (i + 1 == cuts_.size()) break;
      if (values_[i] == 0) {
        i = add_run_of_zeros(i);
      } else if (touching && !changes_sign(i) && !changes_sign(i + 1) &&
                 std::fabs(values_[i]) <= problem_.tolerance(cuts_[i])) {
        add(cuts_[i], 2);
      }
    }
    isolation::add_end_roots(problem_, search_.roots);
  }

 private:
  [[nodiscard]] bool changes_sign(std::size_t i) const {
    return (values_[i - 1] < 0 && values_[i] > 0) || (values_[i - 1] > 0 && values_[i] < 0);
  }
  /// Neighbouring critical points at which p is zero are one root: between two there would be a third. Runs
  /// that meet an end are left to the ends. Returns the run's last index.
  std::size_t add_run_of_zeros(std::size_t i) {
    std::size_t last = i;
    while (last + 1 < cuts_.size() && values_[last + 1] == 0) ++last;
    if (values_[i - 1] != 0 && last + 1 < cuts_.size()) {
      const bool touches = (values_[i - 1] < 0) == (values_[last + 1] < 0);
      add(cuts_[i] + (cuts_[last] - cuts_[i]) / 2, touches ? 2 : 3);
    }
    return last;
  }
  void add_simple(std::size_t i) {
    const auto root = search_.root_between(p_, cuts_[i - 1], cuts_[i], values_[i - 1],
                                           BracketStop<T>{.absolute = search_.absolute});
    const T radius = problem_.tolerance(root.x) / std::fabs(root.derivative) + search_.absolute;
    search_.roots.list.push_back(found_root(root.x, std::min(radius, cuts_[i] - cuts_[i - 1]), 1U));
  }
  /// A root at a critical point, known to what moves p there by the tolerance.
  void add(T x, std::uint32_t multiplicity) {
    const T radius =
        std::sqrt(problem_.tolerance(x) / std::fabs(isolation::evaluate_curve(problem_.c, x).half_curvature));
    search_.roots.list.push_back(found_root(x, std::min(radius, search_.hi - search_.lo), multiplicity));
  }

  const Polynomial& p_;
  const Problem<T>& problem_;
  std::span<const T> cuts_;
  std::span<T> values_;
  Search<T>& search_;
};

template <std::size_t N, class T>
void solve_fixed(const Problem<T>& problem, bool touching, Search<T>& search) {
  Fixed<T, N> p;
  std::copy_n(problem.c.begin(), N + 1, p.c.begin());
  std::array<T, N + 1> memory, values;
  Cuts<T> cuts{memory};
  if constexpr (N == 1) {
    cuts.add(search.lo);
    cuts.add(search.hi);
  } else {
    cascade(p.derivative(), cuts, search);
  }
  LastLevel<T, Fixed<T, N>>(p, problem, cuts.used(), values, search).run(touching);
}

template <class T>
void solve_dynamic(const Problem<T>& problem, bool touching, Search<T>& search) {
  power_basis::Scratch<T> memory(problem.c.size()), values(problem.c.size());
  Cuts<T> cuts{memory.span()};
  cascade(problem.c, cuts, search);
  const Dynamic<T> p{problem.c};
  LastLevel<T, Dynamic<T>>(p, problem, cuts.used(), values.span(), search).run(touching);
}

/// Degrees up to 8 have code of their own: most of what ray tracing asks for.
template <class T>
void solve_any(const Problem<T>& problem, bool touching, Search<T>& search) {
  switch (problem.degree()) {
    case 1:
      return solve_fixed<1>(problem, touching, search);
    case 2:
      return solve_fixed<2>(problem, touching, search);
    case 3:
      return solve_fixed<3>(problem, touching, search);
    case 4:
      return solve_fixed<4>(problem, touching, search);
    case 5:
      return solve_fixed<5>(problem, touching, search);
    case 6:
      return solve_fixed<6>(problem, touching, search);
    case 7:
      return solve_fixed<7>(problem, touching, search);
    case 8:
      return solve_fixed<8>(problem, touching, search);
    default:
      return solve_dynamic(problem, touching, search);
  }
}

}  // namespace

SolverInfo Monotone::info() {
  SolverInfo info;
  info.summary = "a cascade of derivatives cuts the interval into monotone pieces";
  info.source = "Yuksel, Proc. ACM Comput. Graph. Interact. Tech. 5(3) (HPG 2022)";
  info.page = "solvers/monotone.md";
  info.options = {
      {"tolerance", "0", "steps end at this fraction of the interval's width; 0: at rounding (paper: 6e-7)"},
      {"touching", "true", "report critical points at which p is zero within rounding, multiplicity 2"}};
  info.claims = {.finds_touching_roots = true, .certified = false, .deterministic = true};
  info.forms = {Form::polynomial};
  return info;
}

Monotone::Monotone(const Parameters& options)
    : tolerance_(options.number("tolerance", 0)), touching_(options.flag("touching", true)) {
  if (!(tolerance_ >= 0 && tolerance_ < 1))
    throw std::invalid_argument(
        "monotone: tolerance is a fraction of the interval's width, from 0 to below 1");
}

template <class T>
void Monotone::solve(const BasicPolynomialEquation<T>& equation, Roots& roots) const {
  isolation::solve(equation, roots, [this](const Problem<T>& problem, Roots& found) {
    const T absolute = static_cast<T>(tolerance_) * (problem.hi - problem.lo);
    Search<T> search{problem.lo, problem.hi, absolute, found};
    solve_any(problem, touching_, search);
  });
}

template void Monotone::solve(const BasicPolynomialEquation<double>&, Roots&) const;
template void Monotone::solve(const BasicPolynomialEquation<float>&, Roots&) const;

}  // namespace graze
