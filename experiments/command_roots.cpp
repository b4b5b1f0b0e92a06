// graze roots: the root finders by themselves, on polynomials.
#include <cmath>

#include <graze/experiments/truth.hpp>

#include "commands.hpp"
#include "errors.hpp"
#include "json_lines.hpp"

namespace graze {
namespace {

struct RootsOptions {
  std::string solver = std::string(kDefaultSolver);
  std::string precision = "double";
  std::string polynomials;
  bool keep_going = false;
};

void append_status(fmt::memory_buffer& out, Status status, std::string_view why) {
  fmt::format_to(std::back_inserter(out), "],\"status\":\"{}\"", to_string(status));
  if (!why.empty()) {
    fmt::format_to(std::back_inserter(out), ",\"why\":");
    append_json_string(out, why);
  }
  fmt::format_to(std::back_inserter(out), "}}\n");
}

/// Appends one line's answer.
using Answer = std::function<void(const JsonParser::Polynomial&, fmt::memory_buffer&)>;

Answer by_truth() {
  return [](const JsonParser::Polynomial& polynomial, fmt::memory_buffer& out) {
    const truth::PolynomialAnswer answer = truth::real_roots(polynomial.c, polynomial.interval);
    const char* separator = "{\"roots\":[";
    for (const truth::PolynomialRoot& root : answer.roots) {
      fmt::format_to(std::back_inserter(out),
                     "{}{{\"x\":\"{}\",\"multiplicity\":{},\"enclosure\":[\"{}\",\"{}\"]}}", separator,
                     root.x.decimal, root.multiplicity, root.x.lo, root.x.hi);
      separator = ",";
    }
    if (answer.roots.empty()) fmt::format_to(std::back_inserter(out), "{}", separator);
    append_status(out, answer.status, answer.why);
  };
}

/// In the arithmetic of T: coefficients and interval are rounded to it.
template <class T>
Answer by_solver(const SolverSpec& spec) {
  constexpr Precision kPrecision = std::is_same_v<T, float> ? Precision::binary32 : Precision::binary64;
  const std::shared_ptr<AnySolver> solver = find_solver(spec.name).make(spec.options);
  if (!solver->takes(Form::polynomial, kPrecision)) {
    throw UsageError(fmt::format("solver '{}' takes no polynomials in {} (see graze list solvers)", spec.name,
                                 to_string(kPrecision)));
  }
  return [solver](const JsonParser::Polynomial& polynomial, fmt::memory_buffer& out) {
    const std::vector<T> c(polynomial.c.begin(), polynomial.c.end());
    BasicPolynomialEquation<T> equation;
    equation.c = c;
    if (polynomial.interval) {
      equation.lo = static_cast<T>(polynomial.interval->first);
      equation.hi = static_cast<T>(polynomial.interval->second);
    }
    Roots roots;
    solver->solve({&equation, 1}, {&roots, 1});
    fmt::format_to(std::back_inserter(out), "{{\"roots\":[");
    for (std::size_t i = 0; i < roots.list.size(); ++i) {
      const Root& root = roots.list[i];
      // JSON has no infinity: a radius that nothing bounds is null.
      const std::string radius = std::isfinite(root.radius) ? fmt::format("{}", root.radius) : "null";
      fmt::format_to(std::back_inserter(out), "{}{{\"x\":{},\"multiplicity\":{},\"radius\":{}}}",
                     i == 0 ? "" : ",", root.x, root.multiplicity, radius);
    }
    append_status(out, roots.status, "");
  };
}

void find_roots(const RootsOptions& options) {
  const Answer answer = options.solver == "truth" ? by_truth()
                        : parse_precision(options.precision) == Precision::binary32
                            ? by_solver<float>(parse_solver(options.solver))
                            : by_solver<double>(parse_solver(options.solver));
  LineReader reader(options.polynomials);
  JsonParser parser;
  Output output;
  JsonParser::Polynomial polynomial;
  while (const auto line = reader.next()) {
    if (const auto error = parser.parse(*line, polynomial)) {
      if (!options.keep_going) {
        output.flush();
        throw DataError(fmt::format("{}:{}: {}", reader.name(), reader.line(), error->message));
      }
      fmt::format_to(std::back_inserter(output.buffer()), "{{\"roots\":[");
      append_status(output.buffer(), Status::invalid, error->message);
    } else {
      answer(polynomial, output.buffer());
    }
    output.write_if_large();
  }
  output.flush();
}

}  // namespace

Action add_roots_command(CLI::App& app) {
  CLI::App* const command = app.add_subcommand("roots", "real roots of polynomials, by one solver or truth");
  const auto options = std::make_shared<RootsOptions>();
  command->add_option("--solver", options->solver, "solver with options, or truth (default certified)")
      ->type_name("NAME[:key=value,...]|truth");
  add_precision_option(*command, options->precision);
  command->add_flag("--keep-going", options->keep_going, "answer a bad line with status invalid and go on");
  command->add_option(
      "POLYNOMIALS", options->polynomials,
      "JSON Lines {\"c\":[c0,c1,...],\"interval\":[a,b]}, ascending; standard input if missing or -");
  return [options] { find_roots(*options); };
}

}  // namespace graze
