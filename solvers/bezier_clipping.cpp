#include <graze/solvers/bezier_clipping.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <stdexcept>

#include <graze/solvers/isolation.hpp>

namespace graze {
namespace {

using power_basis::kU;
using power_basis::Problem;

template <class T>
struct Piece {
  T a, b;
};

/// Where the convex hull of the points (i / n, b_i +- error) meets the axis: from `first` to `last`, in
/// units of n; empty if first > last.
template <class T>
struct Clip {
  T first = std::numeric_limits<T>::max();
  T last = -1;

  void include(T t) {
    first = std::min(first, t);
    last = std::max(last, t);
  }
};

/// The hull's ends on the axis are ends of chords between a point above it, anywhere in its error bar, and
/// one below: the height of either end moves the crossing one way only.
template <class T>
Clip<T> clip_to_hull(std::span<const T> b, T error) {
  Clip<T> clip;
  for (std::size_t i = 0; i < b.size(); ++i) {
    const T high = b[i] + error, least_high = std::max(b[i] - error, T{0});
    if (high < 0) continue;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const T low = b[j] - error, least_low = std::min(b[j] + error, T{0});
      if (low > 0) continue;
      const auto from = static_cast<T>(i), length = static_cast<T>(j) - from;
      clip.include(from + (least_high > 0 ? least_high / (least_high - low) : 0) * length);
      clip.include(from + (least_low < 0 ? high / (high - least_low) : 1) * length);
    }
  }
  return clip;
}

template <class T>
class Search {
 public:
  Search(const Problem<T>& problem, T split, std::uint32_t budget, Roots& roots)
      : problem_(problem),
        split_(split),
        budget_(budget),
        roots_(roots),
        clusters_(problem, roots),
        memory_(problem.c.size()) {}

  /// Depth first from the left, so that pieces are given up in ascending order.
  void run() {
    push({problem_.lo, problem_.hi});
    while (depth_ > 0 && roots_.status == Status::ok) examine(stack_[--depth_]);
    clusters_.close();
  }

 private:
  static constexpr std::size_t kDepth = 256;  // a split adds one piece: enough for 2^-255 of the interval

  void push(Piece<T> piece) {
    if (depth_ == kDepth || roots_.counters.iterations >= budget_) {
      roots_.status = Status::failed;
    } else {
      stack_[depth_++] = piece;
    }
  }

  void examine(Piece<T> piece) {
    const auto [a, b] = piece;
    const std::span<T> points = memory_.span();
    const T error = isolation::bernstein_on(problem_, a, b, points);
    ++roots_.counters.evaluations;
    ++roots_.counters.iterations;
    const auto clip = clip_to_hull<T>(points, error);
    if (clip.first > clip.last) return;
    // A clip ends about 2 errors from the root on either side, where p is as large; ends of pieces are
    // rounded.
    constexpr T kFew = 4;
    const bool is_noise =
        std::all_of(points.begin(), points.end(), [&](T p) { return std::fabs(p) <= kFew * error; });
    const T rounding = 2 * kU<T> * std::max(std::fabs(a), std::fabs(b));
    if (is_noise || b - a <= kFew * rounding) return clusters_.add(a, b);
    const T scale = (b - a) / static_cast<T>(problem_.degree());
    const T first = std::max(a, a + clip.first * scale - rounding);
    const T last = std::min(b, a + clip.last * scale + rounding);
    if (last - first <= (1 - split_) * (b - a)) return push({first, last});
    const T middle = first + (last - first) / 2;
    push({middle, last});
    push({first, middle});
  }

  const Problem<T>& problem_;
  T split_;
  std::uint32_t budget_;
  Roots& roots_;
  isolation::Clusters<T> clusters_;
  power_basis::Scratch<T> memory_;
  std::array<Piece<T>, kDepth> stack_;
  std::size_t depth_ = 0;
};

}  // namespace

SolverInfo BezierClipping::info() {
  SolverInfo info;
  info.summary = "Bezier clipping by the control polygon's convex hull";
  info.source = "Sederberg, Nishita, CAD 22 (1990)";
  info.page = "solvers/bezier_clipping.md";
  info.options = {{"split", "0.2", "a clip that cuts off less than this part is followed by a subdivision"},
                  {"budget", "20000", "pieces before it says failed"}};
  info.claims = {.finds_touching_roots = true, .certified = false, .deterministic = true};
  info.forms = {Form::polynomial};
  return info;
}

BezierClipping::BezierClipping(const Parameters& options)
    : split_(options.number("split", 0.2)),
      budget_(static_cast<std::uint32_t>(options.integer("budget", 20000, 10, 1000000000))) {
  if (!(split_ > 0 && split_ < 1))
    throw std::invalid_argument("bezier_clipping: split is a part between 0 and 1");
}

template <class T>
void BezierClipping::solve(const BasicPolynomialEquation<T>& equation, Roots& roots) const {
  isolation::solve(equation, roots, [this](const Problem<T>& problem, Roots& found) {
    Search<T>(problem, static_cast<T>(split_), budget_, found).run();
  });
}

template void BezierClipping::solve(const BasicPolynomialEquation<double>&, Roots&) const;
template void BezierClipping::solve(const BasicPolynomialEquation<float>&, Roots&) const;

}  // namespace graze
