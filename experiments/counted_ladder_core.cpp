// Compiled as the solvers that count (counted_sources.hpp is read first): up to the line that says so, double
// is the number that counts and graze the solvers' second namespace.
#include <graze/experiments/counted_ladder.hpp>

#include <graze/solvers/certified.hpp>
#include <graze/solvers/descartes.hpp>
#include <graze/solvers/faithful.hpp>
#include <graze/solvers/interval_bisection.hpp>
#include <graze/solvers/interval_newton.hpp>
#include <graze/solvers/math/big_integer.hpp>

#undef double
#undef graze
// From here on both are what they are everywhere.

namespace graze {
namespace {

using Number = CountingDouble;
using Numbers = std::vector<Number>;

std::vector<counted_graze::Region> regions_of(const LadderRange& range) {
  std::vector<counted_graze::Region> regions;
  for (std::size_t i = 0; i < range.region_ends.size(); ++i)
    regions.push_back({range.region_ends[i], range.region_eps[i]});
  return regions;
}

/// The interval and its epsilons, which look at `regions`.
template <class Equation>
void set_range(const LadderRange& range, std::span<const counted_graze::Region> regions, Equation& to) {
  to.lo = range.lo;
  to.hi = range.hi;
  to.epsilons = {regions, range.grazing_eps, range.shallow};
}

void zeros(const void* /*self*/, std::span<counted_graze::Dyadic> c) {
  std::fill(c.begin(), c.end(), counted_graze::Dyadic());
}

using Enclosure = counted_graze::Interval;

Enclosure enclosed(const LadderInclusions& from, LadderInclusions::Enclose enclose, Enclosure x) {
  double lo = x.lo.value(), hi = x.hi.value();
  enclose(from.self, lo, hi);
  return {lo, hi};
}

LadderAnswer answer_of(const counted_graze::Roots& roots) {
  const counted_graze::Counters& counters = roots.counters;
  LadderAnswer answer{
      {}, static_cast<int>(roots.status), counters.evaluations, counters.iterations, counters.tier};
  for (const counted_graze::Root& root : roots.list) {
    answer.roots.push_back({root.x.value(), root.radius.value(), root.tail.value(), root.multiplicity,
                            root.certified, root.placed, root.side});
  }
  return answer;
}

template <class S>
class LadderModel final : public Ladder {
 public:
  explicit LadderModel(const counted_graze::Parameters& options) : solver_(options) {}

  [[nodiscard]] bool takes_polynomials() const override { return kPolynomials; }
  [[nodiscard]] bool takes_inclusions() const override { return kInclusions; }

  [[nodiscard]] LadderAnswer solve(const LadderPolynomial& from) const override {
    counted_graze::Roots roots;
    if constexpr (kPolynomials) {
      const Numbers c(from.c.begin(), from.c.end()), c_error(from.c_error.begin(), from.c_error.end());
      const auto regions = regions_of(from.range);
      std::vector<counted_graze::DoubleDoubleBall> near;
      for (std::size_t i = 0; i + 2 < from.near.size(); i += 3)
        near.emplace_back(counted_graze::DoubleDouble{from.near[i], from.near[i + 1]}, from.near[i + 2]);
      counted_graze::PolynomialEquation equation;
      equation.c = c;
      equation.c_error = c_error;
      equation.basis = static_cast<counted_graze::Basis>(from.basis);
      set_range(from.range, regions, equation);
      equation.exact.origin = from.origin;
      equation.exact.near = near;
      if (from.has_exact) equation.exact.get = zeros;
      solver_.solve(equation, roots);
    }
    return answer_of(roots);
  }
  [[nodiscard]] LadderAnswer solve(const LadderInclusions& from) const override {
    counted_graze::Roots roots;
    if constexpr (kInclusions) {
      const auto regions = regions_of(from.range);
      counted_graze::IntervalEquation equation;
      equation.self = &from;
      equation.value = [](const void* self, Enclosure x) {
        const auto& one = *static_cast<const LadderInclusions*>(self);
        return enclosed(one, one.value, x);
      };
      equation.derivative = [](const void* self, Enclosure x) {
        const auto& one = *static_cast<const LadderInclusions*>(self);
        return enclosed(one, one.derivative, x);
      };
      set_range(from.range, regions, equation);
      solver_.solve(equation, roots);
    }
    return answer_of(roots);
  }

 private:
  static constexpr bool kPolynomials = counted_graze::Solves<S, counted_graze::PolynomialEquation>;
  static constexpr bool kInclusions = counted_graze::Solves<S, counted_graze::IntervalEquation>;

  S solver_;
};

template <class S>
std::unique_ptr<Ladder> make(const counted_graze::Parameters& options) {
  return std::make_unique<LadderModel<S>>(options);
}

counted_graze::Parameters parameters_of(std::span<const LadderOption> options) {
  counted_graze::Parameters parameters;
  for (const auto& [name, value] : options) {
    if (const auto* const number = std::get_if<double>(&value)) parameters.set(name, Number(*number));
    if (const auto* const flag = std::get_if<bool>(&value)) parameters.set(name, *flag);
    if (const auto* const word = std::get_if<std::string>(&value)) parameters.set(name, *word);
  }
  return parameters;
}

}  // namespace

std::unique_ptr<Ladder> make_ladder(std::string_view name, std::span<const LadderOption> options) {
  const counted_graze::Parameters parameters = parameters_of(options);
  if (name == "certified") return make<counted_graze::Certified>(parameters);
  if (name == "faithful") return make<counted_graze::Faithful>(parameters);
  if (name == "descartes") return make<counted_graze::Descartes>(parameters);
  if (name == "interval_bisection") return make<counted_graze::IntervalBisection>(parameters);
  if (name == "interval_newton") return make<counted_graze::IntervalNewton>(parameters);
  return nullptr;
}

}  // namespace graze
