// The polynomial solvers on polynomials alone, without rays: random ones of degree 3 to 20, side by side in
// one run. Prints a table; ./dev bench polynomials runs it.
//
// The question is Yuksel's (Proc. ACM Comput. Graph. Interact. Tech. 5(3), 2022): his method against
// Jenkins and Traub's up to degree 20, at an error of 6e-7 and at full accuracy; the others for comparison.
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <optional>
#include <string>
#include <vector>

#include <graze/solvers/math/rng.hpp>
#include <graze/surfaces/registry.hpp>

namespace graze {
namespace {

struct Contender {
  std::string label;
  std::unique_ptr<AnySolver> solver;
  int max_degree = 0;  ///< 0: none
};

std::vector<Contender> contenders() {
  std::vector<Contender> all;
  const auto add = [&](std::string label, std::string_view name, const Parameters& options) {
    const SolverEntry& entry = find_solver(name);
    all.push_back({std::move(label), entry.make(options), entry.info.max_degree});
  };
  Parameters paper;
  paper.set("tolerance", 6e-7);
  add("monotone:tolerance=6e-7", "monotone", paper);
  for (const std::string_view name : {"monotone", "jenkins_traub", "companion", "aberth", "laguerre",
                                      "bezier_clipping", "sturm", "descartes", "certified", "closed_form"})
    add(std::string(name), name, {});
  return all;
}

/// Coefficients uniform in [-1, 1], roots wanted in [-1, 1].
struct Polynomials {
  std::vector<double> c;
  std::vector<PolynomialEquation> equations;

  Polynomials(int degree, std::size_t count) : c(count * (static_cast<std::size_t>(degree) + 1)) {
    const std::size_t size = static_cast<std::size_t>(degree) + 1;
    Rng rng(1);
    for (double& v : c) v = rng.uniform(-1, 1);
    for (std::size_t i = 0; i < count; ++i) {
      PolynomialEquation equation;
      equation.c = std::span(c).subspan(i * size, size);
      equation.lo = -1;
      equation.hi = 1;
      equations.push_back(equation);
    }
  }
};

struct Measured {
  double ns = 0;
  std::size_t roots = 0;
};

Measured ask(const Contender& contender, const Polynomials& polynomials, std::vector<Roots>& roots) {
  // Processor time: other programs on the machine count for no side.
  const std::clock_t start = std::clock();
  contender.solver->solve(std::span(polynomials.equations), std::span(roots));
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  Measured measured{1e9 * seconds / static_cast<double>(roots.size()), 0};
  for (const Roots& one : roots) measured.roots += one.list.size();
  return measured;
}

/// Medians of interleaved turns; the number of roots shows who missed some.
void compare(const std::vector<Contender>& all, int degree) {
  constexpr int kRepeats = 9;
  const Polynomials polynomials(degree, 2000);
  std::vector<Roots> roots(polynomials.equations.size());
  std::vector<std::vector<double>> times(all.size());
  std::vector<std::size_t> found(all.size());
  const auto can = [&](const Contender& one) { return one.max_degree == 0 || degree <= one.max_degree; };
  for (int turn = 0; turn < kRepeats; ++turn) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (!can(all[i])) continue;
      for (Roots& one : roots) one.clear();
      const Measured measured = ask(all[i], polynomials, roots);
      times[i].push_back(measured.ns);
      found[i] = measured.roots;
    }
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (times[i].empty()) continue;
    std::nth_element(times[i].begin(), times[i].begin() + kRepeats / 2, times[i].end());
    std::printf("%6d  %-24s %10.0f %8zu\n", degree, all[i].label.c_str(), times[i][kRepeats / 2], found[i]);
  }
}

}  // namespace
}  // namespace graze

int main() {
  const std::vector<graze::Contender> all = graze::contenders();
  std::printf("2000 random polynomials a degree, roots in [-1, 1]; ns each, median of 9 interleaved turns\n");
  std::printf("%6s  %-24s %10s %8s\n", "degree", "solver", "ns", "roots");
  for (const int degree : {3, 4, 5, 6, 8, 10, 12, 16, 20}) graze::compare(all, degree);
}
