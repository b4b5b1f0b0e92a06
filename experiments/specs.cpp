#include "specs.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "errors.hpp"
#include "peers.hpp"
#include "toml_values.hpp"

namespace graze {
namespace {

/// Library errors about names and values are the user's usage errors.
template <class Function>
auto as_usage_error(const std::string& context, const Function& function) {
  try {
    return function();
  } catch (const std::invalid_argument& error) {
    throw UsageError(context + error.what());
  } catch (const UsageError& error) {
    throw UsageError(context + error.what());
  }
}

/// "key=value,key=value" in TOML syntax, through TOML's own inline tables.
Parameters parse_assignments(std::string_view text, std::string_view owner) {
  const std::string origin = fmt::format("'{}'", text);
  if (text.find('\n') != std::string_view::npos) throw UsageError(origin + ": one line, please");
  toml::table table;
  try {
    table = toml::parse(fmt::format("v = {{ {} }}", text));
  } catch (const toml::parse_error& error) {
    throw UsageError(
        fmt::format("{}: {} is not key=value,... in TOML syntax: {}", owner, origin, error.description()));
  }
  Parameters parameters;
  for (const auto& [key, value] : *table["v"].as_table()) {
    parameters.set(std::string(key.str()), toml_parameter(value, std::string(owner), std::string(key.str())));
  }
  return parameters;
}

std::pair<std::string_view, std::string_view> split_name(std::string_view text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) return {text, {}};
  return {text.substr(0, colon), text.substr(colon + 1)};
}

/// "NAME:key=value,..."; `find` gives the entry of a name or throws std::invalid_argument.
template <class Find>
SolverSpec read_solver(std::string_view name, std::string_view assignments, const Find& find) {
  SolverSpec spec;
  spec.name = std::string(name);
  spec.options_text = std::string(assignments);
  spec.options = parse_assignments(assignments, name);
  as_usage_error("", [&] { return find(spec.name).make(spec.options); });
  return spec;
}

constexpr std::string_view kPeer = "peer";

/// A solver or a peer, whose name has a colon of its own: "peer:embree:triangles=1000".
SolverSpec parse_solver_or_peer(std::string_view text) {
  const auto [first, rest] = split_name(text);
  if (first != kPeer) return parse_solver(text);
  const std::string_view assignments = split_name(rest).second;
  const std::size_t used = assignments.empty() ? 0 : assignments.size() + 1;
  return read_solver(text.substr(0, text.size() - used), assignments, find_solver_or_peer);
}

std::string to_text(const ParameterValue& value) {
  const auto list = [](const std::vector<double>& numbers) {
    return fmt::format("[{}]", fmt::join(numbers, ","));
  };
  if (const auto* number = std::get_if<double>(&value)) return fmt::format("{}", *number);
  if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  if (const auto* word = std::get_if<std::string>(&value)) return fmt::format("\"{}\"", *word);
  if (const auto* numbers = std::get_if<std::vector<double>>(&value)) return list(*numbers);
  std::vector<std::string> rows;
  for (const auto& row : std::get<std::vector<std::vector<double>>>(value)) rows.push_back(list(row));
  return fmt::format("[{}]", fmt::join(rows, ","));
}

// ------------------------------------------------------------------------------------------------- scenes

Vec3 to_vec3(const std::vector<double>& v) { return {v[0], v[1], v[2]}; }

Mat3 read_matrix(const toml::node& node, const std::string& file) {
  const toml::array* const rows = node.as_array();
  if (rows == nullptr || rows->size() != 3) {
    throw UsageError(where(node, file, "matrix") + "expected 3 rows of 3 numbers");
  }
  return {to_vec3(toml_numbers((*rows)[0], file, "matrix", 3)),
          to_vec3(toml_numbers((*rows)[1], file, "matrix", 3)),
          to_vec3(toml_numbers((*rows)[2], file, "matrix", 3))};
}

std::string read_word(const toml::node& node, const std::string& file, const std::string& field) {
  if (const auto text = node.value<std::string>()) return *text;
  throw UsageError(where(node, file, field) + "expected a string");
}

/// Complains about a formulation that the surface does not have, at its place in the file.
void check_formulation(const SceneMember& member, const std::string& place) {
  std::vector<std::string_view> known;
  for (const FormulationInfo& formulation : find_surface(member.surface.type).formulations) {
    if (formulation.name == member.formulation) return;
    known.push_back(formulation.name);
  }
  throw UsageError(place +
                   unknown_name_message("formulation of " + member.surface.type, member.formulation, known));
}

/// The field that a complaint of a surface is about: its sentence begins with the name of a parameter, or
/// with "parameter 'NAME'". "surface" if it does not.
std::string field_of(std::string_view message, const SurfaceInfo& info) {
  constexpr std::string_view kPrefix = "parameter '";
  if (message.substr(0, kPrefix.size()) == kPrefix) message.remove_prefix(kPrefix.size());
  for (const std::string_view name : info.parameters) {
    if (message.substr(0, name.size()) != name) continue;
    const char next = message.size() > name.size() ? message[name.size()] : ' ';
    if (next == ' ' || next == '[' || next == ':' || next == '\'') return std::string(name);
  }
  return "surface";
}

/// Builds the surface once, so that a bad value is reported with its place in the file.
void check_surface(const SurfaceSpec& surface, const toml::table& table, const std::string& file) {
  const SurfaceEntry* entry = nullptr;
  as_usage_error(where(table, file, "type"), [&] { return entry = &find_surface(surface.type); });
  try {
    entry->make(surface);
  } catch (const std::invalid_argument& error) {
    const std::string field = field_of(error.what(), entry->info);
    const toml::node* const node = table.get(field);
    throw UsageError(where(node != nullptr ? *node : table, file, field) + error.what());
  }
}

/// One [[surface]]: the fields every surface has, and its parameters.
SceneMember read_member(const toml::table& table, const std::string& file) {
  SceneMember member;
  for (const auto& [key, value] : table) {
    const std::string field(key.str());
    if (field == "type") {
      member.surface.type = read_word(value, file, field);
    } else if (field == "name") {
      member.surface.name = read_word(value, file, field);
    } else if (field == "solver") {
      member.solver = read_word(value, file, field);
      as_usage_error(where(value, file, field), [&] { return parse_solver(member.solver); });
    } else if (field == "formulation") {
      member.formulation = read_word(value, file, field);
    } else if (field == "translate") {
      member.surface.placement.translate = to_vec3(toml_numbers(value, file, field, 3));
    } else if (field == "matrix") {
      member.surface.placement.matrix = read_matrix(value, file);
    } else if (field == "eps") {
      const toml::table* const eps = value.as_table();
      if (eps == nullptr) throw UsageError(where(value, file, field) + "expected a table region = number");
      for (const auto& [region, number] : *eps) {
        member.surface.eps[std::string(region.str())] =
            toml_number(number, file, "eps." + std::string(region.str()));
      }
    } else {
      member.surface.parameters.set(field, toml_parameter(value, file, field));
    }
  }
  if (member.surface.type.empty()) throw UsageError(where(table, file, "type") + "missing");
  check_surface(member.surface, table, file);
  if (const toml::node* const node = table.get("formulation")) {
    check_formulation(member, where(*node, file, "formulation"));
  }
  return member;
}

}  // namespace

SurfaceSpec parse_surface(std::string_view text) {
  const auto [name, assignments] = split_name(text);
  SurfaceSpec spec;
  spec.type = std::string(name);
  as_usage_error("", [&, type = name] { return &find_surface(type); });
  spec.parameters = parse_assignments(assignments, name);
  as_usage_error(fmt::format("surface {}: ", name), [&] { return find_surface(spec.type).make(spec); });
  return spec;
}

std::string surface_label(const SurfaceSpec& spec) {
  std::vector<std::string> parts;
  for (const auto& [key, value] : spec.parameters.values()) parts.push_back(key + "=" + to_text(value));
  return parts.empty() ? spec.type : fmt::format("{}:{}", spec.type, fmt::join(parts, ","));
}

SolverSpec parse_solver(std::string_view text) {
  const auto [name, assignments] = split_name(text);
  if (name == kPeer) throw UsageError(fmt::format("solver '{}': peers are for graze bench only", text));
  return read_solver(name, assignments, find_solver);
}

std::vector<SolverSpec> parse_solver_list(std::string_view text) {
  std::vector<std::string> parts;
  std::size_t start = 0;
  while (start <= text.size()) {
    const std::size_t comma = std::min(text.find(',', start), text.size());
    const std::string_view part = text.substr(start, comma - start);
    const bool is_option =
        part.find('=') != std::string_view::npos && part.find(':') == std::string_view::npos;
    if (is_option && !parts.empty()) {
      parts.back() += "," + std::string(part);
    } else {
      parts.emplace_back(part);
    }
    start = comma + 1;
  }
  std::vector<SolverSpec> solvers;
  for (const std::string& part : parts) solvers.push_back(parse_solver_or_peer(part));
  return solvers;
}

std::vector<SceneMember> read_scene(const std::string& path) {
  const toml::table root = parse_toml_file(path);
  const toml::node* const surfaces = root.get("surface");
  const toml::array* const list = surfaces == nullptr ? nullptr : surfaces->as_array();
  if (list == nullptr || list->empty()) throw UsageError(path + ": no [[surface]] in this scene");
  std::vector<SceneMember> members;
  for (const toml::node& node : *list) {
    const toml::table* const table = node.as_table();
    if (table == nullptr) throw UsageError(where(node, path, "surface") + "expected [[surface]] tables");
    members.push_back(read_member(*table, path));
  }
  return members;
}

Scene build_scene(std::span<const SceneMember> members, const SolverSpec& solver, Query query) {
  Scene scene;
  for (const SceneMember& member : members) {
    const SolverSpec chosen = member.solver.empty() ? solver : parse_solver(member.solver);
    const std::string& formulation = member.formulation.empty() ? solver.formulation : member.formulation;
    as_usage_error("", [&] {
      const SolverEntry& entry = find_solver_or_peer(chosen.name);
      scene.add(seen_by(entry, find_surface(member.surface.type), query), member.surface, entry,
                {chosen.options, formulation, solver.precision});
      return 0;
    });
  }
  return scene;
}

SurfaceSpec scaled(const SurfaceSpec& spec, double factor) {
  SurfaceSpec result = spec;
  result.parameters = find_surface(spec.type).scaled(spec.parameters, factor);
  result.placement.translate = factor * result.placement.translate;
  return result;
}

}  // namespace graze
