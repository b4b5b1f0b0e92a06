#include <graze/solvers/sturm.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include <graze/solvers/isolation.hpp>

namespace graze {
namespace {

using power_basis::Coefficients;
using power_basis::Problem;

/// p, p', and each further member the negative remainder of the two before it; every one of them times a
/// power of two. Member k starts where k - 1 ends; sizes fall from one member to the next.
template <class T>
class Sequence {
 public:
  explicit Sequence(Coefficients<T> c) : sizes_(c.size()), work_(c.size()), terms_(c.size()) {
    const std::size_t numbers = c.size() * (c.size() + 1) / 2;
    if (numbers > inline_.size()) heap_.resize(numbers);
    std::copy(c.begin(), c.end(), work_.span().begin());
    append(c.size(), 1);
    for (std::size_t i = 1; i < c.size(); ++i) work_.span()[i - 1] = static_cast<T>(i) * c[i];
    append(c.size() - 1, 1);
    while (const std::size_t size = remainder()) append(size, -1);
    is_sound_ = is_sound_ && last_divides_first();
  }

  /// False: rounding has cut the sequence short, and its counts mean nothing.
  [[nodiscard]] bool is_sound() const { return is_sound_; }

  /// Sign variations at x.
  [[nodiscard]] int variations(T x) {
    int count = 0;
    T last = 0;
    for (std::size_t k = 0, start = 0; k < members_; start += sizes_.span()[k++]) {
      const Coefficients<T> p = memory().subspan(start, sizes_.span()[k]);
      const T value = power_basis::evaluate(p, x).value;
      if (value == 0) continue;
      if (last != 0 && (value < 0) != (last < 0)) ++count;
      last = value;
    }
    return count;
  }

 private:
  static constexpr std::size_t kNumbers = (power_basis::kInline + 1) * (power_basis::kInline + 2) / 2;

  std::span<T> memory() { return heap_.empty() ? std::span<T>(inline_) : std::span<T>(heap_); }

  /// Appends sign times the first `size` numbers of the work space, scaled so that the largest is about 1.
  void append(std::size_t size, int sign) {
    T largest = 0;
    for (const T c : work_.span().first(size)) largest = std::max(largest, std::fabs(c));
    const int power = std::ilogb(largest);
    for (std::size_t i = 0; i < size; ++i)
      memory()[used_ + i] = static_cast<T>(sign) * std::ldexp(work_.span()[i], -power);
    sizes_.span()[members_++] = size;
    used_ += size;
  }

  /// Leaves the remainder of a division in the work space and the magnitudes of what was subtracted in
  /// terms_.
  void divide(Coefficients<T> dividend, Coefficients<T> divisor) {
    const std::span<T> rest = work_.span(), terms = terms_.span();
    const std::size_t low = divisor.size();
    for (std::size_t i = 0; i < dividend.size(); ++i) terms[i] = std::fabs(rest[i] = dividend[i]);
    for (std::size_t k = dividend.size(); k-- > low - 1;) {
      const T quotient = rest[k] / divisor[low - 1];
      for (std::size_t j = 0; j + 1 < low; ++j) {
        const T term = quotient * divisor[j];
        rest[k - low + 1 + j] -= term;
        terms[k - low + 1 + j] += std::fabs(term);
      }
    }
  }

  /// Size of the next member, which is left in the work space: 0 where nothing is left above the rounding of
  /// the terms that cancelled.
  std::size_t remainder() {
    const std::size_t low = sizes_.span()[members_ - 1], high = sizes_.span()[members_ - 2];
    if (low < 2) return 0;
    divide(memory().subspan(used_ - low - high, high), memory().subspan(used_ - low, low));
    // The same multiple of rounding as everywhere counts as zero.
    const T rounding =
        static_cast<T>(power_basis::kBackward) * static_cast<T>(sizes_.span()[0] - 1) * power_basis::kU<T>;
    std::size_t size = low - 1;
    bool dropped = false;
    for (; size > 0 && std::fabs(work_.span()[size - 1]) <= rounding * terms_.span()[size - 1]; --size)
      dropped = dropped || work_.span()[size - 1] != 0;
    // What follows a leading coefficient of rounding has lost its digits as well.
    if (dropped && size > 0) is_sound_ = false;
    return size;
  }

  /// A last member that is no constant claims to divide p. Half of the digits are asked for.
  [[nodiscard]] bool last_divides_first() {
    const std::size_t size = sizes_.span()[members_ - 1];
    if (size < 2) return true;
    divide(memory().first(sizes_.span()[0]), memory().subspan(used_ - size, size));
    const T half = std::sqrt(power_basis::kU<T>);
    for (std::size_t i = 0; i + 1 < size; ++i)
      if (!(std::fabs(work_.span()[i]) <= half * terms_.span()[i])) return false;
    return true;
  }

  power_basis::Scratch<std::size_t> sizes_;
  power_basis::Scratch<T> work_, terms_;
  std::array<T, kNumbers> inline_;
  std::vector<T> heap_;
  std::size_t members_ = 0, used_ = 0;
  bool is_sound_ = true;
};

/// A point of the bisection: the value of p and the variations there.
template <class T>
struct Point {
  T x = 0, value = 0;
  int variations = 0;
};

template <class T>
class Search {
 public:
  Search(const Problem<T>& problem, std::uint32_t budget, Roots& roots)
      : problem_(problem), budget_(budget), roots_(roots), sequence_(problem.c), clusters_(problem, roots) {}

  /// Depth first from the left.
  void run() {
    Point<T> hi = at(problem_.hi);
    // Just below a root there is one variation more: roots at the ends are the ends' affair.
    if (hi.value == 0) ++hi.variations;
    push({at(problem_.lo), hi});
    while (depth_ > 0 && roots_.status == Status::ok) examine(stack_[--depth_]);
    clusters_.close();
    isolation::add_end_roots(problem_, roots_);
    if (!sequence_.is_sound() && roots_.status == Status::ok) roots_.status = Status::uncertain;
  }

 private:
  struct Piece {
    Point<T> a, b;
  };
  static constexpr std::size_t kDepth = 256;  // a split adds one piece: enough for 2^-255 of the interval

  void push(const Piece& piece) {
    if (depth_ == kDepth || roots_.counters.iterations >= budget_) {
      roots_.status = Status::failed;
    } else {
      stack_[depth_++] = piece;
    }
  }

  Point<T> at(T x) {
    ++roots_.counters.evaluations;
    return {x, power_basis::evaluate(problem_.c, x).value, sequence_.variations(x)};
  }

  void examine(const Piece piece) {
    const auto& [a, b] = piece;
    ++roots_.counters.iterations;
    const int count = a.variations - b.variations;
    const bool changes = (a.value < 0 && b.value > 0) || (a.value > 0 && b.value < 0);
    // What p itself shows is not left to the sequence.
    if (count <= 0 && !changes) return;
    if (count <= 1 && changes) return isolation::add_bracketed(problem_, a.x, b.x, a.value < 0, roots_);
    split(piece);
  }

  /// At a point where p is clearly not zero, so that no root is cut. Where there is none the piece is a
  /// cluster.
  void split(const Piece& piece) {
    const T a = piece.a.x, width = piece.b.x - piece.a.x;
    for (const T fraction : isolation::kSplits<T>) {
      const T x = a + fraction * width;
      if (!(x > a && x < piece.b.x)) break;
      const Point<T> middle = at(x);
      if (std::fabs(middle.value) <= problem_.tolerance(x)) continue;
      push({middle, piece.b});
      return push({piece.a, middle});
    }
    clusters_.add(a, piece.b.x);
  }

  const Problem<T>& problem_;
  std::uint32_t budget_;
  Roots& roots_;
  Sequence<T> sequence_;
  isolation::Clusters<T> clusters_;
  std::array<Piece, kDepth> stack_;
  std::size_t depth_ = 0;
};

}  // namespace

SolverInfo Sturm::info() {
  SolverInfo info;
  info.summary = "Sturm sequence, bisection on its sign variations, then Newton in the bracket";
  info.source = "Sturm 1829; Basu, Pollack, Roy, Springer 2006, section 2.2";
  info.page = "solvers/sturm.md";
  info.options = {{"budget", "20000", "pieces before it says failed"}};
  info.claims = {.finds_touching_roots = true, .certified = false, .deterministic = true};
  info.forms = {Form::polynomial};
  return info;
}

Sturm::Sturm(const Parameters& options)
    : budget_(static_cast<std::uint32_t>(options.integer("budget", 20000, 10, 1000000000))) {}

template <class T>
void Sturm::solve(const BasicPolynomialEquation<T>& equation, Roots& roots) const {
  isolation::solve(equation, roots, [this](const Problem<T>& problem, Roots& found) {
    Search<T>(problem, budget_, found).run();
  });
}

template void Sturm::solve(const BasicPolynomialEquation<double>&, Roots&) const;
template void Sturm::solve(const BasicPolynomialEquation<float>&, Roots&) const;

}  // namespace graze
