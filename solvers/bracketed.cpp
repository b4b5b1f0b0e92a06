#include <graze/solvers/bracketed.hpp>

#include <algorithm>
#include <cmath>

#include <boost/math/policies/policy.hpp>
#include <boost/math/tools/toms748_solve.hpp>

#include <graze/solvers/bracket_methods.hpp>
#include <graze/solvers/math/polynomial.hpp>
#include <graze/solvers/slices.hpp>

namespace graze {
namespace {

using bracket::Bracket;
using power_basis::Coefficients;
using power_basis::kU;
using Method = Bracketed::Method;

/// How narrow a bracket at x is to be: two ulps of x, or of u^2 times the largest |x| asked for, so that a
/// root at zero, which has no ulps, ends the iteration as well.
template <class T>
struct Resolution {
  T reach;
  T operator()(T x) const { return 4 * kU<T> * std::max(std::fabs(x), kU<T> * kU<T> * reach); }
  [[nodiscard]] bool is_narrow(T a, T b) const {
    return b - a <= (*this)(std::max(std::fabs(a), std::fabs(b)));
  }
};

/// Boost throws nothing: what it would refuse is never asked. It keeps new points two ulps from the ends, so
/// it is asked for no less than four ulps; below that it bisects without end.
template <class T, class F>
Bracket<T> toms748(const F& f, const Bracket<T>& start, const Resolution<T>& resolution) {
  using boost::math::policies::ignore_error;
  using Quiet = boost::math::policies::policy<boost::math::policies::domain_error<ignore_error>,
                                              boost::math::policies::evaluation_error<ignore_error>>;
  const auto narrow = [&](T a, T b) { return b - a <= 2 * resolution(std::max(std::fabs(a), std::fabs(b))); };
  std::uintmax_t steps = Bracketed::kBudget;
  const auto [a, b] =
      boost::math::tools::toms748_solve(f, start.a, start.b, start.fa, start.fb, narrow, steps, Quiet());
  return {a, b, 0, 0};
}

/// Halves until the values are far from overflow, where interpolation divides infinities.
template <class T, class F>
Bracket<T> with_tame_values(const F& f, Bracket<T> bracket) {
  const T large = std::sqrt(std::numeric_limits<T>::max());
  for (int i = 0; i < Bracketed::kBudget; ++i) {
    if (std::fabs(bracket.fa) < large && std::fabs(bracket.fb) < large) break;
    const T x = bracket::middle(bracket);
    if (!(bracket.a < x && x < bracket.b)) break;
    shrink(bracket, x, f(x));
  }
  return bracket;
}

/// The bracket of f's change of sign, as narrow as `resolution` or as the budget allows.
template <class T, class F>
Bracket<T> refined(Method method, const F& f, Bracket<T> bracket, const Resolution<T>& resolution) {
  bracket = with_tame_values(f, bracket);
  if (resolution.is_narrow(bracket.a, bracket.b)) return bracket;
  const auto narrow = [&](T a, T b) { return resolution.is_narrow(a, b); };
  switch (method) {
    case Method::toms748:
      return toms748(f, bracket, resolution);
    case Method::itp: {
      const T nearest = std::min(std::fabs(bracket.a), std::fabs(bracket.b));
      const T epsilon = resolution((bracket.a < 0) == (bracket.b < 0) ? nearest : T{0}) / 2;
      return itp(f, bracket, epsilon, bracket::ItpParameters<T>{T(0.2) / (bracket.b - bracket.a)}, narrow,
                 Bracketed::kBudget);
    }
    case Method::chandrupatla:
      return chandrupatla(f, bracket, resolution, Bracketed::kBudget);
  }
  return bracket;
}

// ------------------------------------------------------------------------------------------- polynomials

/// An end of a monotone piece, or a root: of multiplicity 0 if it is an end of the interval.
template <class T>
struct Node {
  T x = 0;
  std::uint32_t multiplicity = 0;
  T radius = 0;
};

/// p^(k) / k!, with a bound on what rounding and the coefficients' errors do to its value.
template <class T>
struct Level {
  Coefficients<T> c;
  Coefficients<T> c_error;  // only for k = 0; separators of monotone pieces need none

  [[nodiscard]] T value(T x) const { return power_basis::evaluate(c, x).value; }

  /// Running error bound of Horner's rule (Higham, algorithm 5.1).
  [[nodiscard]] T bound(T x) const {
    T y = c.back(), mu = 0;
    for (std::size_t i = c.size() - 1; i-- > 0;) {
      const T product = y * x;
      y = product + c[i];
      mu = mu * std::fabs(x) + (std::fabs(product) + std::fabs(y));
    }
    return kU<T> * mu + power_basis::magnitude_sum(c_error, x);
  }
  /// -1, 0 (no more than its error) or 1.
  [[nodiscard]] int sign(T x) const {
    const T y = value(x), error = bound(x);
    if (std::fabs(y) <= error && std::isfinite(error)) return 0;
    return y > 0 ? 1 : -1;
  }
};

/// Roots between the zeros of the derivative, from the constant derivative up to p itself.
template <class T>
class DerivativeChain {
 public:
  DerivativeChain(Method method, T lo, T hi, Roots& roots)
      : method_(method),
        lo_(lo),
        hi_(hi),
        resolution_{std::max(std::fabs(lo), std::fabs(hi))},
        roots_(roots) {}

  /// Visits the roots of p in [lo, hi], ascending.
  template <class Visit>
  void run(Coefficients<T> c, Coefficients<T> c_error, const Visit& visit) {
    const std::size_t n = c.size() - 1;
    power_basis::Scratch<T> scratch(n + 1);
    power_basis::Scratch<Node<T>> first(n + 1), second(n + 1);
    std::span<Node<T>> nodes = first.span(), found = second.span();
    std::size_t count = with_ends(nodes, 0);
    for (std::size_t k = n; k-- > 0;) {
      const Level<T> level = k == 0 ? Level<T>{c, c_error} : derivative(c, k, scratch.span());
      // Room for the low end at index 0.
      std::size_t next = 1;
      if (k == 0) {
        roots_between(level, nodes.first(count), visit);
        return;
      }
      roots_between(level, nodes.first(count), [&](const Node<T>& node) {
        if (next + 1 < found.size()) found[next++] = node;
      });
      count = with_ends(found, next - 1);
      std::swap(nodes, found);
    }
  }

 private:
  /// lo, the `inner` nodes that stand from index 1 on, hi.
  std::size_t with_ends(std::span<Node<T>> nodes, std::size_t inner) const {
    nodes[0] = {lo_};
    nodes[inner + 1] = {hi_};
    return inner + 2;
  }

  static Level<T> derivative(Coefficients<T> c, std::size_t k, std::span<T> out) {
    T binomial = 1;  // C(i + k, k)
    for (std::size_t i = 0; i + k < c.size(); ++i) {
      out[i] = binomial * c[i + k];
      binomial = binomial * static_cast<T>(i + k + 1) / static_cast<T>(i + 1);
    }
    return {out.first(c.size() - k), {}};
  }

  /// The level is monotone between neighbouring nodes: there a change of sign is one root; nodes where it
  /// is zero within its error are roots, neighbouring ones of them the same.
  template <class Visit>
  void roots_between(const Level<T>& level, std::span<const Node<T>> nodes, const Visit& visit) {
    int last = 0;  // sign at the node before; 0: none
    for (std::size_t i = 0; i < nodes.size();) {
      const int sign = sign_at(level, nodes[i].x);
      if (sign != 0) {
        if (last * sign < 0) visit(simple_root(level, nodes[i - 1].x, nodes[i].x));
        last = sign;
        ++i;
        continue;
      }
      std::size_t end = i + 1;
      while (end < nodes.size() && sign_at(level, nodes[end].x) == 0) ++end;
      const int after = end < nodes.size() ? sign_at(level, nodes[end].x) : 0;
      visit(run_of_zeros(level, nodes.subspan(i, end - i), last * after));
      last = 0;
      // A zero node has taken the change of sign on both its sides.
      i = end;
      if (i < nodes.size()) {
        last = after;
        ++i;
      }
    }
  }

  int sign_at(const Level<T>& level, T x) {
    ++roots_.counters.evaluations;
    return level.sign(x);
  }

  Node<T> simple_root(const Level<T>& level, T a, T b) {
    const auto f = [&](T x) {
      ++roots_.counters.evaluations;
      ++roots_.counters.iterations;
      return level.value(x);
    };
    const Bracket<T> start{a, b, level.value(a), level.value(b)};
    const Bracket<T> end = refined(method_, f, start, resolution_);
    if (!(end.b - end.a <= 4 * resolution_(end.a))) roots_.status = Status::failed;
    const T x = bracket::middle(end);
    const T slope = std::fabs(power_basis::evaluate(level.c, x).derivative);
    return {x, 1, std::min((end.b - end.a) + level.bound(x) / slope, b - a)};
  }

  /// `parity` < 0: the signs on both sides differ, > 0: they are the same, 0: an end of the interval.
  Node<T> run_of_zeros(const Level<T>& level, std::span<const Node<T>> run, int parity) const {
    std::uint32_t multiplicity = 1;
    for (const Node<T>& node : run) multiplicity += node.multiplicity;
    const bool odd = multiplicity % 2 == 1;
    if (parity != 0 && odd == (parity > 0) && multiplicity > 1) --multiplicity;
    const T x = run.front().x + (run.back().x - run.front().x) / 2;
    const auto n = static_cast<T>(level.c.size() - 1);
    const T spread = std::pow(n * kU<T>, T{1} / static_cast<T>(multiplicity)) * std::fabs(x);
    return {x, multiplicity, (run.back().x - run.front().x) / 2 + spread};
  }

  Method method_;
  T lo_, hi_;
  Resolution<T> resolution_;
  Roots& roots_;
};

/// A bound of all roots, in T.
template <class T>
T bound_of_roots(Coefficients<T> c) {
  power_basis::Scratch<double> wide(c.size());
  std::transform(c.begin(), c.end(), wide.span().begin(), [](T a) { return static_cast<double>(a); });
  const double bound =
      std::min(root_bound(wide.span()), static_cast<double>(std::numeric_limits<T>::max() / 2));
  return std::nextafter(static_cast<T>(bound), std::numeric_limits<T>::max());
}

/// In the unknown y = x / 2^shift, in which the coefficients are of one size.
template <class T>
void solve_problem(const power_basis::Problem<T>& problem, Method method, Roots& roots) {
  power_basis::Scratch<T> c(problem.c.size()), c_error(problem.c_error.size());
  const auto powers = power_basis::scale_coefficients(problem.c, c.span());
  const int shift = powers.shift, power = powers.power;
  for (std::size_t i = 0; i < problem.c_error.size(); ++i)
    c_error.span()[i] = std::ldexp(problem.c_error[i], static_cast<int>(i) * shift - power);
  const T bound = bound_of_roots<T>(c.span());
  const T lo = std::max(std::ldexp(problem.lo, -shift), -bound);
  const T hi = std::min(std::ldexp(problem.hi, -shift), bound);
  if (!(lo <= hi)) return;
  DerivativeChain<T>(method, lo, hi, roots).run(c.span(), c_error.span(), [&](const Node<T>& node) {
    const T x = std::clamp(std::ldexp(node.x, shift), problem.lo, problem.hi);
    roots.list.push_back(found_root(x, std::ldexp(node.radius, shift), node.multiplicity));
  });
}

// ---------------------------------------------------------------------------------------- scalar functions

/// A point of the curve.
template <class T>
struct Sample {
  T x;
  BasicJet<T> jet;
};

template <class T>
class ScalarSearch {
 public:
  ScalarSearch(const BasicScalarEquation<T>& equation, Method method, Roots& roots)
      : equation_(equation),
        method_(method),
        resolution_{std::max(std::fabs(equation.lo), std::fabs(equation.hi))},
        roots_(roots) {}

  void run(int pieces) {
    Sample<T> a = sample(equation_.lo);
    if (a.jet.f == 0) add(a, 0, 1);
    for (int i = 1; i <= pieces && !is_complete() && a.x < equation_.hi; ++i) {
      const T part = static_cast<T>(i) / static_cast<T>(pieces);
      const Sample<T> b =
          sample(i == pieces ? equation_.hi : equation_.lo + part * (equation_.hi - equation_.lo));
      examine(a, b, kSplits);
      if (b.jet.f == 0) add(b, 0, 1);
      a = b;
    }
    merge();
  }

 private:
  /// Times a piece may be halved where f and f' contradict each other at its ends.
  static constexpr int kSplits = 10;

  Sample<T> sample(T x) {
    ++roots_.counters.evaluations;
    return {x, equation_(x)};
  }
  [[nodiscard]] bool is_complete() const {
    return equation_.max_roots > 0 && roots_.list.size() >= static_cast<std::size_t>(equation_.max_roots);
  }

  /// Finds what f and f' at the ends show of the open piece.
  void examine(const Sample<T>& a, const Sample<T>& b, int splits) {
    const T fa = a.jet.f, fb = b.jet.f;
    if ((fa < 0 && fb > 0) || (fa > 0 && fb < 0)) {
      // Both slopes against the change of sign: at least two extrema hide here.
      if (splits > 0 && points_away(a, fb) && points_away(b, fb)) {
        split(a, b, splits);
      } else {
        add_change_of_sign(a, b);
      }
    } else if (fa == 0 || fb == 0) {
      const T inner = fa != 0 ? fa : fb;
      const T slope = fa == 0 ? a.jet.df : -b.jet.df;
      // f leaves its zero at one end to the side away from its sign at the other: it must come back.
      const bool dips = (inner > 0 && slope < 0) || (inner < 0 && slope > 0) || (fa == 0 && fb == 0);
      if (dips && splits > 0) split(a, b, splits);
    } else if (turns_towards_zero(a, b)) {
      add_around_extremum(a, b);
    } else if (splits > 0 && contradicts(a, b)) {
      split(a, b, splits);
    }
  }

  void split(const Sample<T>& a, const Sample<T>& b, int splits) {
    const Sample<T> m = sample(a.x + (b.x - a.x) / 2);
    if (!(a.x < m.x && m.x < b.x)) return;
    examine(a, m, splits - 1);
    if (m.jet.f == 0) add(m, 0, 1);
    examine(m, b, splits - 1);
  }

  static bool points_away(const Sample<T>& s, T towards) {
    return (towards > 0 && s.jet.df < 0) || (towards < 0 && s.jet.df > 0);
  }
  /// |f| falls into the piece from both ends.
  static bool turns_towards_zero(const Sample<T>& a, const Sample<T>& b) {
    const bool minimum = a.jet.df < 0 && b.jet.df > 0;
    const bool maximum = a.jet.df > 0 && b.jet.df < 0;
    return a.jet.f > 0 ? minimum : maximum;
  }
  /// The mean slope has the other sign than both slopes at the ends: no monotone f does that.
  static bool contradicts(const Sample<T>& a, const Sample<T>& b) {
    const T rise = b.jet.f - a.jet.f;
    return (rise > 0 && a.jet.df < 0 && b.jet.df < 0) || (rise < 0 && a.jet.df > 0 && b.jet.df > 0);
  }

  /// An extremum: f' changes sign. It touches zero, crosses it twice, or stays away.
  void add_around_extremum(const Sample<T>& a, const Sample<T>& b) {
    const auto slope = [this](T x) { return sample(x).jet.df; };
    const Bracket<T> start{a.x, b.x, a.jet.df, b.jet.df};
    const Bracket<T> end = refined(method_, slope, start, resolution_);
    const Sample<T> c = sample(bracket::middle(end));
    ++roots_.counters.iterations;
    if (slices::is_root(c.x, c.jet)) {
      add(c, end.b - end.a, 2);
    } else if ((c.jet.f < 0) != (a.jet.f < 0)) {
      add_change_of_sign(a, c);
      add_change_of_sign(c, b);
    }
  }

  void add_change_of_sign(const Sample<T>& a, const Sample<T>& b) {
    const auto f = [this](T x) {
      ++roots_.counters.iterations;
      return sample(x).jet.f;
    };
    const Bracket<T> start{a.x, b.x, a.jet.f, b.jet.f};
    const Bracket<T> end = refined(method_, f, start, resolution_);
    if (!(end.b - end.a <= 4 * resolution_(end.a))) roots_.status = Status::failed;
    add(sample(bracket::middle(end)), end.b - end.a, 1);
  }

  /// Radius: the bracket, and what the noise of f leaves open by the slope, or by the curvature where the
  /// slope is too small to tell.
  void add(const Sample<T>& s, T bracket_width, std::uint32_t multiplicity) {
    const T open = slices::noise(s.x, s.jet);
    const bool touches = s.jet.df * s.jet.df <= 2 * std::fabs(s.jet.ddf) * open;
    const T by_slope = 2 * open / std::fabs(s.jet.df);
    const T by_curvature = 2 * std::sqrt(2 * open / std::fabs(s.jet.ddf));
    // Neither is of use where f' and f'' vanish: then the resolution of a triple root.
    const T widest = std::cbrt(kU<T>) * (equation_.hi - equation_.lo);
    const T radius = std::min(touches ? by_curvature : by_slope, widest);
    const bool is_exact_touch = bracket_width == 0 && s.jet.f == 0 && touches && s.jet.ddf != 0;
    roots_.list.push_back(found_root(s.x, bracket_width + (radius >= 0 ? radius : widest),
                                     is_exact_touch ? std::max(multiplicity, 2U) : multiplicity));
  }

  /// Roots that cannot be told apart are one: |x - y| <= r_x + r_y, as in solvers/slices.hpp.
  void merge() {
    std::vector<Root>& list = roots_.list;
    std::size_t kept = 0;
    for (const Root& root : list) {
      if (kept > 0 && root.x - list[kept - 1].x <= list[kept - 1].radius + root.radius) {
        Root& merged = list[kept - 1];
        const double apart = root.x - merged.x;
        merged.x = static_cast<double>(static_cast<T>(merged.x + 0.5 * apart));
        merged.radius = std::max(merged.radius, root.radius) + 0.5 * apart;
        merged.multiplicity += root.multiplicity;
      } else {
        list[kept++] = root;
      }
    }
    list.resize(kept);
  }

  const BasicScalarEquation<T>& equation_;
  Method method_;
  Resolution<T> resolution_;
  Roots& roots_;
};

Method method_named(const std::string& name) {
  if (name == "toms748") return Method::toms748;
  if (name == "itp") return Method::itp;
  if (name == "chandrupatla") return Method::chandrupatla;
  throw std::invalid_argument("bracketed: method '" + name + "' is none of toms748, itp, chandrupatla");
}

}  // namespace

SolverInfo Bracketed::info() {
  SolverInfo info;
  info.summary = "changes of sign, each refined by a bracketing method";
  info.source = "Alefeld, Potra, Shi 1995; Oliveira, Takahashi 2020; Chandrupatla 1997";
  info.page = "solvers/bracketed.md";
  info.options = {{"method", "toms748", "toms748, itp or chandrupatla"},
                  {"pieces", "32", "uniform pieces in which a scalar function is searched"}};
  info.claims = {.finds_touching_roots = true, .certified = false, .deterministic = true};
  info.forms = {Form::scalar, Form::polynomial};
  return info;
}

Bracketed::Bracketed(const Parameters& options)
    : method_(method_named(options.word("method", "toms748"))),
      pieces_(options.integer("pieces", 32, 1, 1000000)) {}

template <class T>
void Bracketed::solve(const BasicPolynomialEquation<T>& equation, Roots& roots) const {
  power_basis::solve(equation, roots, [this](const power_basis::Problem<T>& problem, Roots& found) {
    solve_problem(problem, method_, found);
  });
}

template <class T>
void Bracketed::solve(const BasicScalarEquation<T>& equation, Roots& roots) const {
  if (!std::isfinite(equation.lo) || !std::isfinite(equation.hi) || !(equation.lo <= equation.hi)) {
    roots.status = Status::invalid;
    return;
  }
  ScalarSearch<T>(equation, method_, roots).run(pieces_);
}

template void Bracketed::solve(const BasicPolynomialEquation<double>&, Roots&) const;
template void Bracketed::solve(const BasicPolynomialEquation<float>&, Roots&) const;
template void Bracketed::solve(const BasicScalarEquation<double>&, Roots&) const;
template void Bracketed::solve(const BasicScalarEquation<float>&, Roots&) const;

}  // namespace graze
