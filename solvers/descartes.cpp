#include <graze/solvers/descartes.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include <graze/solvers/bernstein_copy.hpp>
#include <graze/solvers/isolation.hpp>
#include <graze/solvers/math/bernstein.hpp>
#include <graze/solvers/math/double_double_ball.hpp>
#include <graze/solvers/math/polynomial.hpp>

namespace graze {
namespace {

inline constexpr std::size_t kDepth = 256;  // a split adds one piece: enough for 2^-255 of the interval

/// Control values on a piece with bounds of their errors; only their signs are asked for.
struct Controls {
  std::array<double, kMaxBernsteinSize> value, error;
  std::size_t size = 0;

  [[nodiscard]] bool is_clear(std::size_t i) const { return std::fabs(value[i]) > error[i]; }
  [[nodiscard]] SignVariations variations() const {
    return sign_variations({value.data(), size}, {error.data(), size});
  }
};

/// A ball as a value with its error: the sign is the ball's where the ball has one.
Evaluation evaluation_of(const DoubleDoubleBall& ball) {
  constexpr double kSlack = 1 + 0x1p-50;  // the roundings of the bound itself
  return {ball.value().hi, kSlack * (std::fabs(ball.value().lo) + ball.error())};
}

/// The power basis, the unknown is x. What doubles leave without a sign is computed again with the
/// coefficients in double-double, where the equation has them.
struct PowerForm {
  std::span<const double> c, c_error;
  std::span<const DoubleDoubleBall> near{};
  mutable bool used_near = false;

  /// Bernstein coefficients of p on [a, b] times binomials: Horner's rule, in which a factor x turns s_j into
  /// a s_j + b s_{j-1}. No division, and a and b are exact.
  void controls(double a, double b, Controls& out) const {
    const std::size_t n = c.size() - 1;
    out.size = c.size();
    out.value[0] = c[n];
    out.error[0] = detail::error_at(c_error, n);
    for (std::size_t k = 1; k <= n; ++k) {
      for (std::size_t j = k + 1; j-- > 0;) {
        detail::WeightedSum sum;
        if (j < k) sum.add({a, 0}, {out.value[j], out.error[j]});
        if (j > 0) sum.add({b, 0}, {out.value[j - 1], out.error[j - 1]});
        sum.add(detail::binomial_ball(k, j), detail::ball_at(c, c_error, n - k));
        const Evaluation result = sum.result();
        out.value[j] = result.value;
        out.error[j] = result.error;
      }
    }
  }
  /// The same in double-double, where the equation has such coefficients.
  void finer_controls(double a, double b, Controls& out) const {
    used_near = true;
    const DoubleDoubleBall from(a), to(b);
    const std::size_t n = c.size() - 1;
    std::array<DoubleDoubleBall, kMaxBernsteinSize> s;
    s[0] = near[n];
    for (std::size_t k = 1; k <= n; ++k) {
      for (std::size_t j = k + 1; j-- > 0;) {
        const detail::Ball ways = detail::binomial_ball(k, j);
        DoubleDoubleBall sum = DoubleDoubleBall(ways.value, ways.error) * near[n - k];
        if (j < k) sum += from * s[j];
        if (j > 0) sum += to * s[j - 1];
        s[j] = sum;
      }
    }
    for (std::size_t j = 0; j <= n; ++j) {
      const Evaluation control = evaluation_of(s[j]);
      out.value[j] = control.value;
      out.error[j] = control.error;
    }
  }
  [[nodiscard]] Evaluation value(double x) const {
    const Evaluation quick = evaluate(c, c_error, x);
    return near.empty() || std::fabs(quick.value) > quick.error ? quick : near_value(x);
  }
  [[nodiscard]] DerivativeEvaluation slope(double x) const {
    DerivativeEvaluation p = evaluate_with_derivative(c, c_error, x);
    if (near.empty() || std::fabs(p.value) > p.error) return p;
    const Evaluation finer = near_value(x);
    p.value = finer.value;
    p.error = finer.error;
    return p;
  }
  /// One Newton step with a residual in double-double, from a root that doubles know no better.
  [[nodiscard]] double polished(double x, double a, double b) const {
    if (near.empty()) return x;
    const double moved = x - near_value(x).value / evaluate_with_derivative(c, c_error, x).derivative;
    return moved > a && moved < b ? moved : x;
  }
  [[nodiscard]] bool has_finer() const { return !near.empty(); }
  [[nodiscard]] bool is_zero_at(double x) const { return evaluate(c, c_error, point(x)) == Interval{}; }
  [[nodiscard]] static Interval unknown(Interval x) { return x; }

 private:
  [[nodiscard]] Evaluation near_value(double x) const {
    DoubleDoubleBall p;
    const DoubleDoubleBall at(x);
    for (std::size_t i = c.size(); i-- > 0;) p = p * at + near[i];
    return evaluation_of(p);
  }
};

/// The Bernstein basis, the unknown is t = (x - lo) / (hi - lo).
struct BernsteinForm {
  std::span<const double> b, b_error;
  double lo, hi;

  /// On [a', b] with a' <= a where a rounds: a root between a' and a is told by the signs at a and b.
  void controls(double from, double to, Controls& out) const {
    out.size = b.size();
    bernstein_restrict(b, b_error, {from, to}, {out.value.data(), out.size}, {out.error.data(), out.size});
  }
  static void finer_controls(double /*from*/, double /*to*/, Controls& /*out*/) {}
  [[nodiscard]] static double polished(double t, double /*a*/, double /*b*/) { return t; }
  [[nodiscard]] static bool has_finer() { return false; }
  [[nodiscard]] Evaluation value(double t) const { return bernstein_evaluate(b, b_error, t); }
  [[nodiscard]] DerivativeEvaluation slope(double t) const {
    return bernstein_evaluate_with_derivative(b, b_error, t);
  }
  [[nodiscard]] bool is_zero_at(double t) const {
    const Evaluation end = value(t);
    return end.value == 0 && end.error == 0;
  }
  [[nodiscard]] Interval unknown(Interval t) const {
    if (lo == 0 && hi == 1) return t;
    const Interval x = point(lo) + t * (point(hi) - point(lo));
    return {std::clamp(x.lo, lo, hi), std::clamp(x.hi, lo, hi)};
  }
};

/// The certified search. `zero_a`, `zero_b`: p vanishes there exactly, and that root is listed already.
template <class Form>
class CertifiedSearch {
 public:
  CertifiedSearch(const Form& form, std::uint32_t budget, Roots& roots)
      : form_(form), budget_(budget), roots_(roots) {}

  /// Depth first from the left, so that roots come out in ascending order.
  void run(double lo, double hi) {
    finest_ = kFinest * (hi - lo);
    const bool zero_lo = form_.is_zero_at(lo), zero_hi = form_.is_zero_at(hi);
    if (lo == hi) return examine_point(lo, zero_lo);
    if (zero_lo) add({lo, lo});
    push({lo, hi, zero_lo, zero_hi});
    while (depth_ > 0) {
      if (roots_.counters.iterations >= budget_) {
        roots_.status = Status::uncertain;
        break;
      }
      examine(stack_[--depth_]);
      // Whoever has finer coefficients has exact ones too, and asks those for every root.
      if (form_.has_finer() && roots_.status == Status::uncertain) return;
    }
    if (zero_hi) add({hi, hi});
  }

 private:
  struct Piece {
    double a, b;
    bool zero_a, zero_b;
  };

  /// An interval of one point: a root there is a simple one if p' has a sign.
  void examine_point(double x, bool is_zero) {
    const DerivativeEvaluation p = form_.slope(x);
    const bool is_simple = std::fabs(p.derivative) > p.derivative_error;
    if (is_zero && is_simple) return add({x, x});
    if (is_zero || sign(x) == 0) roots_.status = Status::uncertain;
  }

  void push(const Piece& piece) {
    if (depth_ < kDepth) {
      stack_[depth_++] = piece;
    } else {
      roots_.status = Status::uncertain;
    }
  }

  /// The proved sign of p; 0: not known.
  int sign(double x) {
    ++roots_.counters.evaluations;
    const Evaluation p = form_.value(x);
    return p.value > p.error ? 1 : p.value < -p.error ? -1 : 0;
  }

  void examine(const Piece piece) {
    ++roots_.counters.iterations;
    ++roots_.counters.evaluations;
    form_.controls(piece.a, piece.b, controls_);
    if (settle(piece)) return;
    const bool is_open = !is_told_;
    if (is_open && form_.has_finer()) {
      ++roots_.counters.evaluations;
      form_.finer_controls(piece.a, piece.b, controls_);
      if (settle(piece)) return;
    }
    if (is_noise() || (is_open && form_.has_finer() && piece.b - piece.a < finest_)) {
      roots_.status = Status::uncertain;
    } else {
      split(piece);
    }
  }

  /// Whether the control values tell all: no root, or one, which is refined and listed.
  bool settle(const Piece& piece) {
    const std::size_t last = controls_.size - 1;
    if (piece.zero_a) controls_.value[0] = controls_.error[0] = 0;
    if (piece.zero_b) controls_.value[last] = controls_.error[last] = 0;
    // An end must have a sign, or be a simple root: then its neighbour has one.
    const bool clear_a = controls_.is_clear(piece.zero_a ? std::min<std::size_t>(1, last) : 0);
    const bool clear_b = controls_.is_clear(piece.zero_b && last > 0 ? last - 1 : last);
    const SignVariations variations = controls_.variations();
    is_told_ = clear_a && clear_b && variations.lower == variations.upper;
    if (clear_a && clear_b) {
      if (variations.upper == 0) return true;
      if (variations.lower == 1 && variations.upper == 1 && !piece.zero_a && !piece.zero_b) {
        const int at_a = sign(piece.a), at_b = sign(piece.b);
        if (at_a != 0 && at_b != 0) {
          if (at_a != at_b) refine(piece.a, piece.b, at_a);
          return true;
        }
      }
    }
    return false;
  }

  /// No control value has a sign: smaller pieces will have none either.
  [[nodiscard]] bool is_noise() const {
    for (std::size_t i = 0; i < controls_.size; ++i)
      if (controls_.is_clear(i)) return false;
    return true;
  }

  /// At a point where p is clearly not zero, so that no root is cut: the middle, or a little beside it. Where
  /// no point has a sign rounding hides what is between them.
  void split(const Piece& piece) {
    for (const double fraction : isolation::kSplits<double>) {
      const double m = piece.a + fraction * (piece.b - piece.a);
      if (!(m > piece.a && m < piece.b)) break;
      if (sign(m) == 0) continue;
      push({m, piece.b, false, piece.zero_b});
      push({piece.a, m, piece.zero_a, false});
      return;
    }
    roots_.status = Status::uncertain;
  }

  /// (a, b) holds exactly one root and the signs at its ends are proved. Newton finds it; then the ends come
  /// as near as their signs can be proved.
  void refine(double a, double b, int at_a) {
    const auto p = [&](double at) { return form_.slope(at); };
    const auto noise = [&](double at) { return form_.value(at).error; };
    const auto root = newton_in_bracket(p, noise, a, b, at_a < 0, BracketStop<double>{});
    roots_.counters.evaluations += root.steps;
    roots_.counters.iterations += root.steps;
    const double x = form_.polished(root.x, a, b);
    const double start = std::max(2 * form_.value(x).error / std::fabs(root.derivative), ulp(x));
    const double below = end_with_sign(x, a, start, at_a);
    const double above = end_with_sign(x, b, start, -at_a);
    add({below, above});
  }

  /// The first of x + d, x + 4 d, ... towards `end` at which p has the sign proved; else `end`, which has it.
  double end_with_sign(double x, double end, double step, int wanted) {
    constexpr double kGrowth = 4;
    for (double d = step; d < std::fabs(end - x); d *= kGrowth) {
      const double at = end < x ? x - d : x + d;
      if (sign(at) == wanted) return at;
    }
    return end;
  }

  void add(Interval enclosure) {
    const Interval x = form_.unknown(enclosure);
    const double centre = mid(x);
    const double radius = is_point(x) ? 0 : std::max(sub_up(x.hi, centre), sub_up(centre, x.lo));
    roots_.list.push_back(
        {.x = centre, .others = {}, .radius = radius, .multiplicity = 1, .certified = true});
  }

  const Form& form_;
  std::uint32_t budget_;
  Roots& roots_;
  /// Of the interval: pieces in which doubles tell less are left to integers. Roots that are nearer to each
  /// other are almost always one: a ray an ulp beside a tangent has two that are 2^-26 apart.
  static constexpr double kFinest = 0x1p-36;

  double finest_ = 0;
  bool is_told_ = false;  ///< the number of variations of the last piece is known, and so are its ends' signs
  Controls controls_;
  std::array<Piece, kDepth> stack_;
  std::size_t depth_ = 0;
};

/// The same plan without proofs.
template <class T>
class PlainSearch {
 public:
  PlainSearch(const power_basis::Problem<T>& problem, std::uint32_t budget, Roots& roots)
      : problem_(problem),
        budget_(budget),
        roots_(roots),
        clusters_(problem, roots),
        memory_(problem.c.size()) {}

  void run() {
    stack_[depth_++] = {problem_.lo, problem_.hi};
    while (depth_ > 0 && roots_.status == Status::ok) examine(stack_[--depth_]);
    clusters_.close();
    isolation::add_end_roots(problem_, roots_);
  }

 private:
  struct Piece {
    T a, b;
  };

  void examine(const Piece piece) {
    const auto [a, b] = piece;
    const std::span<T> p = memory_.span();
    const T error = isolation::bernstein_on(problem_, a, b, p);
    ++roots_.counters.evaluations;
    if (++roots_.counters.iterations > budget_) roots_.status = Status::failed;
    int variations = 0;
    T last = p[0];
    bool is_noise = true;
    for (const T value : p) {
      is_noise = is_noise && std::fabs(value) <= error;
      if (value == 0) continue;
      if ((value < 0) != (last < 0) && last != 0) ++variations;
      last = value;
    }
    if (is_noise) return clusters_.add(a, b);
    if (variations == 0) return;
    const bool changes = (p.front() < 0 && p.back() > 0) || (p.front() > 0 && p.back() < 0);
    if (variations == 1 && changes) return isolation::add_bracketed(problem_, a, b, p.front() < 0, roots_);
    split(piece);
  }

  /// As in the certified search; where no point has a sign the piece is a cluster.
  void split(const Piece& piece) {
    const T a = piece.a, width = piece.b - piece.a;
    for (const T fraction : isolation::kSplits<T>) {
      const T m = a + fraction * width;
      if (!(m > a && m < piece.b)) break;
      ++roots_.counters.evaluations;
      if (std::fabs(power_basis::evaluate(problem_.c, m).value) <= problem_.tolerance(m)) continue;
      if (depth_ + 2 > kDepth) {
        roots_.status = Status::failed;
        return;
      }
      stack_[depth_++] = {m, piece.b};
      stack_[depth_++] = {a, m};
      return;
    }
    clusters_.add(a, piece.b);
  }

  const power_basis::Problem<T>& problem_;
  std::uint32_t budget_;
  Roots& roots_;
  isolation::Clusters<T> clusters_;
  power_basis::Scratch<T> memory_;
  std::array<Piece, kDepth> stack_;
  std::size_t depth_ = 0;
};

bool is_exact(const PolynomialEquation& equation) { return effective_degree(equation.c_error) < 0; }

/// Infinite ends become twice the root bound, where p has a sign. False: there is no such number, or the
/// coefficients' errors could move roots beyond it.
bool bound_ends(const PolynomialEquation& equation, double& lo, double& hi) {
  if (std::isfinite(lo) && std::isfinite(hi)) return true;
  const double bound = 2 * root_bound(equation.c);
  if (!is_exact(equation) || !std::isfinite(bound)) return false;
  lo = std::max(lo, -bound);
  hi = std::min(hi, bound);
  return true;
}

}  // namespace

SolverInfo Descartes::info() {
  SolverInfo info;
  info.summary =
      "Descartes' rule in the Bernstein basis with certain signs, bisection, Newton in the bracket";
  info.source = "Collins, Akritas 1976; Lane, Riesenfeld, BIT 21 (1981)";
  info.page = "solvers/descartes.md";
  info.options = {{"budget", "20000", "pieces before it says uncertain"}};
  info.claims = {.finds_touching_roots = false, .certified = true, .deterministic = true};
  info.forms = {Form::polynomial};
  info.max_degree = kMaxBernsteinDegree;
  return info;
}

Descartes::Descartes(const Parameters& options)
    : budget_(static_cast<std::uint32_t>(options.integer("budget", 20000, 10, 1000000000))) {}

void Descartes::solve(const BasicPolynomialEquation<double>& equation, Roots& roots) const {
  const int degree = effective_degree(equation.c);
  if (!is_usable(equation)) {
    roots.status = Status::invalid;
  } else if (degree < 0) {
    roots.status = is_exact(equation) ? Status::coincident : Status::uncertain;
  } else if (equation.basis == Basis::chebyshev) {
    if (BernsteinCopy::suits(equation)) return solve(BernsteinCopy(equation).equation(), roots);
    roots.status = Status::failed;
  } else if (equation.basis == Basis::bernstein) {
    if (equation.c.size() > kMaxBernsteinSize) {
      roots.status = Status::failed;
      return;
    }
    const BernsteinForm form{equation.c, equation.c_error, equation.lo, equation.hi};
    CertifiedSearch<BernsteinForm>(form, budget_, roots).run(0, 1);
  } else {
    // Leading zeros that are exact do not count.
    const std::size_t size = is_exact(equation) ? static_cast<std::size_t>(degree) + 1 : equation.c.size();
    double lo = equation.lo, hi = equation.hi;
    if (size > kMaxBernsteinSize) {
      roots.status = Status::failed;
    } else if (!bound_ends(equation, lo, hi)) {
      roots.status = Status::uncertain;
    } else if (lo <= hi) {
      const auto error = equation.c_error.empty() ? equation.c_error : equation.c_error.first(size);
      const auto near = equation.exact.near.empty() ? equation.exact.near : equation.exact.near.first(size);
      const PowerForm form{equation.c.first(size), error, near};
      CertifiedSearch<PowerForm>(form, budget_, roots).run(lo, hi);
      if (form.used_near) roots.counters.tier = 2;  // as solvers/certified.md counts them
    }
  }
}

void Descartes::solve(const BasicPolynomialEquation<float>& equation, Roots& roots) const {
  isolation::solve(equation, roots, [this](const power_basis::Problem<float>& problem, Roots& found) {
    PlainSearch<float>(problem, budget_, found).run();
  });
}

}  // namespace graze
