#include <graze/experiments/counted_ladder.hpp>

#include <graze/experiments/counted_solver.hpp>
#include <graze/solvers/math/double_double_ball.hpp>
#include <graze/surfaces/registry.hpp>

namespace graze {
namespace {

LadderRange range_of(double lo, double hi, const Epsilons& epsilons) {
  LadderRange range{lo, hi, {}, {}, epsilons.grazing_eps, epsilons.shallow};
  for (const Region& region : epsilons.parts) {
    range.region_ends.push_back(region.end);
    range.region_eps.push_back(region.eps);
  }
  return range;
}

LadderPolynomial ladder_polynomial(const PolynomialEquation& from) {
  LadderPolynomial to;
  to.range = range_of(from.lo, from.hi, from.epsilons);
  to.c = from.c;
  to.c_error = from.c_error;
  to.basis = static_cast<int>(from.basis);
  to.has_exact = from.exact.get != nullptr;
  to.origin = from.exact.origin;
  for (const DoubleDoubleBall& ball : from.exact.near)
    to.near.insert(to.near.end(), {ball.value().hi, ball.value().lo, ball.error()});
  return to;
}

template <Interval (*IntervalEquation::*kFunction)(const void*, Interval)>
void enclose(const void* self, double& lo, double& hi) {
  const auto& equation = *static_cast<const IntervalEquation*>(self);
  const Interval f = (equation.*kFunction)(equation.self, {lo, hi});
  lo = f.lo;
  hi = f.hi;
}

LadderInclusions ladder_inclusions(const IntervalEquation& from) {
  return {range_of(from.lo, from.hi, from.epsilons), &from, enclose<&IntervalEquation::value>,
          enclose<&IntervalEquation::derivative>};
}

void take(const LadderAnswer& from, Roots& to) {
  for (const LadderRoot& root : from.roots) {
    to.list.push_back({.x = root.x,
                       .others = {},
                       .radius = root.radius,
                       .multiplicity = root.multiplicity,
                       .certified = root.certified,
                       .tail = root.tail,
                       .placed = root.placed,
                       .side = root.side});
  }
  to.status = static_cast<Status>(from.status);
  to.counters.evaluations = from.evaluations;
  to.counters.iterations = from.iterations;
  to.counters.tier = from.tier;
}

std::vector<LadderOption> ladder_options(const Parameters& options) {
  std::vector<LadderOption> result;
  for (const auto& [name, value] : options.values()) {
    if (const auto* const number = std::get_if<double>(&value)) result.emplace_back(name, *number);
    if (const auto* const flag = std::get_if<bool>(&value)) result.emplace_back(name, *flag);
    if (const auto* const word = std::get_if<std::string>(&value)) result.emplace_back(name, *word);
  }
  return result;
}

/// The counting solver gives the answer; where it would have asked for exact coefficients, the plain one.
class CountedLadder final : public CountedSolver {
 public:
  CountedLadder(std::string_view name, const Parameters& options)
      : ladder_(make_ladder(name, ladder_options(options))), plain_(find_solver(name).make(options)) {}

  [[nodiscard]] bool takes(Form form) const override {
    return (form == Form::polynomial && ladder_->takes_polynomials()) ||
           (form == Form::interval && ladder_->takes_inclusions());
  }
  [[nodiscard]] bool counts_any_basis() const override { return true; }

  void solve(const PolynomialEquation& equation, Roots& roots, OperationCount& count) const override {
    if (!ladder_->takes_polynomials()) counted::refuse();
    constexpr std::uint32_t kExact = 3;  // Counters::tier
    const LadderPolynomial same = ladder_polynomial(equation);
    const CountingScope scope(count);
    const LadderAnswer answer = ladder_->solve(same);
    if (!same.has_exact || answer.tier < kExact) return take(answer, roots);
    plain_->solve(std::span(&equation, 1), std::span(&roots, 1));
  }
  void solve(const IntervalEquation& equation, Roots& roots, OperationCount& count) const override {
    if (!ladder_->takes_inclusions()) counted::refuse();
    const CountingScope scope(count);
    take(ladder_->solve(ladder_inclusions(equation)), roots);
  }
  void solve(const ScalarEquation& /*e*/, Roots& /*r*/, OperationCount& /*c*/) const override {
    counted::refuse();
  }
  void solve(const SystemEquation& /*e*/, Roots& /*r*/, OperationCount& /*c*/) const override {
    counted::refuse();
  }

 private:
  std::unique_ptr<Ladder> ladder_;
  std::unique_ptr<AnySolver> plain_;
};

}  // namespace

std::unique_ptr<CountedSolver> make_counted_ladder(std::string_view name, const Parameters& options) {
  return std::make_unique<CountedLadder>(name, options);
}

}  // namespace graze
