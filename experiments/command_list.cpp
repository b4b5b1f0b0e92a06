// graze list: what this build has.
#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cases.hpp"
#include "commands.hpp"
#include "json_lines.hpp"
#include "peers.hpp"

namespace graze {
namespace {

using Json = nlohmann::ordered_json;

std::vector<std::string> form_names(const std::vector<Form>& forms) {
  std::vector<std::string> names;
  for (const Form form : forms) names.emplace_back(to_string(form));
  return names;
}

/// The precisions in which a solver takes at least one form, "double" or "double, float".
std::vector<std::string_view> precisions_of(const SolverEntry& entry) {
  std::vector<std::string_view> names;
  for (const Precision precision : {Precision::binary64, Precision::binary32}) {
    const auto& forms = entry.info.forms;
    const bool works =
        std::any_of(forms.begin(), forms.end(), [&](Form form) { return entry.takes(form, precision); });
    if (works) names.push_back(to_string(precision));
  }
  return names;
}

/// "any degree" or "degree <= 2"; empty for solvers that take no polynomials.
std::string degree_limit(const SolverInfo& info) {
  if (std::find(info.forms.begin(), info.forms.end(), Form::polynomial) == info.forms.end()) return "";
  return info.max_degree == 0 ? "any degree" : fmt::format("degree <= {}", info.max_degree);
}

/// 0 stands for "any" and "depends on the surface": JSON says null.
Json known_degree(int degree) { return degree == 0 ? Json(nullptr) : Json(degree); }

std::vector<SolverEntry> peers() {
  std::vector<SolverEntry> entries;
  for (const Peer& peer : peer_registry()) entries.push_back(peer.solver);
  return entries;
}

Json solvers_json(const std::vector<SolverEntry>& entries) {
  Json list = Json::array();
  for (const SolverEntry& entry : entries) {
    Json options = Json::array();
    for (const auto& option : entry.info.options) {
      options.push_back({{"name", option.name}, {"default", option.fallback}, {"meaning", option.meaning}});
    }
    const auto& claims = entry.info.claims;
    list.push_back({{"name", entry.name},
                    {"summary", entry.info.summary},
                    {"forms", form_names(entry.info.forms)},
                    {"precisions", precisions_of(entry)},
                    {"max_degree", known_degree(entry.info.max_degree)},
                    {"claims",
                     {{"finds_touching_roots", claims.finds_touching_roots},
                      {"certified", claims.certified},
                      {"deterministic", claims.deterministic}}},
                    {"options", options},
                    {"source", entry.info.source},
                    {"page", entry.info.page}});
  }
  return list;
}

Json surfaces_json() {
  Json list = Json::array();
  for (const SurfaceEntry& entry : surface_registry()) {
    Json formulations = Json::array();
    for (const FormulationInfo& formulation : entry.formulations) {
      formulations.push_back({{"name", formulation.name},
                              {"summary", formulation.summary},
                              {"forms", form_names(formulation.forms)},
                              {"degree", known_degree(formulation.degree)},
                              {"plain", formulation.is_plain},
                              {"source", formulation.source}});
    }
    list.push_back({{"name", entry.name},
                    {"summary", entry.info.summary},
                    {"parameters", entry.info.parameters},
                    {"params", entry.info.params},
                    {"varieties", entry.info.varieties},
                    {"eps_regions", entry.info.regions},
                    {"formulations", formulations},
                    {"source", entry.info.source},
                    {"page", entry.info.page}});
  }
  return list;
}

Json cases_json() {
  Json list = Json::array();
  for (const CaseFamily& family : case_families()) {
    list.push_back({{"name", family.name}, {"summary", family.summary}, {"difficulty", family.difficulty}});
  }
  return list;
}

void print_solvers(std::string_view title, const std::vector<SolverEntry>& entries, fmt::memory_buffer& out) {
  if (entries.empty()) return;
  fmt::format_to(std::back_inserter(out), "{}\n", title);
  for (const SolverEntry& entry : entries) {
    const auto& claims = entry.info.claims;
    const std::string degrees = degree_limit(entry.info);
    fmt::format_to(std::back_inserter(out), "  {:<20} {}\n  {:<20}   forms: {}{}{}; in {}; {}{}{}\n",
                   entry.name, entry.info.summary, "", fmt::join(form_names(entry.info.forms), ", "),
                   degrees.empty() ? "" : "; ", degrees, fmt::join(precisions_of(entry), ", "),
                   claims.certified ? "certified" : "not certified",
                   claims.finds_touching_roots ? ", sees touching roots" : ", does not decide touching roots",
                   claims.deterministic ? "" : ", seeded random starts");
    for (const auto& option : entry.info.options) {
      fmt::format_to(std::back_inserter(out), "  {:<20}   {}={}: {}\n", "", option.name, option.fallback,
                     option.meaning);
    }
    fmt::format_to(std::back_inserter(out), "  {:<20}   source: {}; see {}\n", "", entry.info.source,
                   entry.info.page);
  }
}

/// What a surface is, and what it has beside formulations.
void print_about(const SurfaceEntry& entry, fmt::memory_buffer& out) {
  const SurfaceInfo& info = entry.info;
  const std::string regions =
      info.regions.empty() ? "" : fmt::format("; eps regions: {}", fmt::join(info.regions, ", "));
  fmt::format_to(std::back_inserter(out), "  {:<20} {}\n  {:<20}   parameters: {}{}; see {}\n", entry.name,
                 info.summary, "", fmt::join(info.parameters, ", "), regions, info.page);
  if (info.varieties.empty()) return;
  fmt::format_to(std::back_inserter(out), "  {:<20}   varieties: {}\n", "", fmt::join(info.varieties, ", "));
}

void print_surfaces(fmt::memory_buffer& out) {
  fmt::format_to(std::back_inserter(out), "surfaces\n");
  for (const SurfaceEntry& entry : surface_registry()) {
    print_about(entry, out);
    for (const FormulationInfo& formulation : entry.formulations) {
      const std::string degree =
          formulation.degree == 0 ? "" : fmt::format(", degree {}", formulation.degree);
      fmt::format_to(std::back_inserter(out), "  {:<20}   {} [{}{}{}]: {}\n", "", formulation.name,
                     fmt::join(form_names(formulation.forms), ", "), degree,
                     formulation.is_plain ? ", never certified" : "", formulation.summary);
    }
  }
}

void print_cases(fmt::memory_buffer& out) {
  fmt::format_to(std::back_inserter(out), "cases\n");
  for (const CaseFamily& family : case_families()) {
    fmt::format_to(std::back_inserter(out), "  {:<20} {}\n  {:<20}   difficulty: {}\n", family.name,
                   family.summary, "", family.difficulty);
  }
}

struct ListOptions {
  std::string what;
  bool json = false;
};

void list(const ListOptions& options) {
  const auto wanted = [&](std::string_view part) { return options.what.empty() || options.what == part; };
  Output output;
  if (options.json) {
    Json all;
    if (wanted("solvers")) all["solvers"] = solvers_json(solver_registry());
    if (wanted("solvers") && !peer_registry().empty()) all["peers"] = solvers_json(peers());
    if (wanted("surfaces")) all["surfaces"] = surfaces_json();
    if (wanted("cases")) all["cases"] = cases_json();
    fmt::format_to(std::back_inserter(output.buffer()), "{}\n", all.dump(2));
  } else {
    if (wanted("solvers")) {
      print_solvers("solvers", solver_registry(), output.buffer());
      print_solvers("peers (for graze bench)", peers(), output.buffer());
    }
    if (wanted("surfaces")) print_surfaces(output.buffer());
    if (wanted("cases")) print_cases(output.buffer());
  }
  output.flush();
}

}  // namespace

Action add_list_command(CLI::App& app) {
  CLI::App* const command = app.add_subcommand("list", "solvers, surfaces and case families of this build");
  const auto options = std::make_shared<ListOptions>();
  command->add_option("WHAT", options->what, "solvers, surfaces or cases; all if missing")
      ->check(CLI::IsMember({"solvers", "surfaces", "cases"}));
  command->add_flag("--json", options->json, "as JSON");
  return [options] { list(*options); };
}

}  // namespace graze
