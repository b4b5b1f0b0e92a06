#define TOML_IMPLEMENTATION
#include "toml_values.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include <fmt/format.h>

#include "errors.hpp"
#include "numbers.hpp"

namespace graze {

toml::table parse_toml(std::string_view text, const std::string& origin) {
  try {
    return toml::parse(text, origin);
  } catch (const toml::parse_error& error) {
    throw UsageError(
        fmt::format("{}:{}: not valid TOML: {}", origin, error.source().begin.line, error.description()));
  }
}

toml::table parse_toml_file(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw UsageError(fmt::format("{}: cannot read: {}", path, std::strerror(errno)));
  std::ostringstream text;
  text << file.rdbuf();
  if (file.bad()) throw EnvironmentError(fmt::format("{}: read failed", path));
  return parse_toml(text.str(), path);
}

std::string where(const toml::node& node, const std::string& file, const std::string& field) {
  const auto line = node.source().begin.line;
  const std::string place = line > 0 ? fmt::format("{}:{}", file, line) : file;
  return fmt::format("{}: field '{}': ", place, field);
}

double toml_number(const toml::node& node, const std::string& file, const std::string& field) {
  if (const auto number = node.value<double>(); number && node.is_number()) return *number;
  if (const auto text = node.value<std::string>()) {
    if (const auto number = parse_hex_float(*text)) return *number;
  }
  throw UsageError(where(node, file, field) + "expected a number");
}

std::vector<double> toml_numbers(const toml::node& node, const std::string& file, const std::string& field,
                                 std::size_t count) {
  const toml::array* const list = node.as_array();
  if (list == nullptr || (count > 0 && list->size() != count)) {
    throw UsageError(where(node, file, field) + (count > 0
                                                     ? fmt::format("expected a list of {} numbers", count)
                                                     : "expected a list of numbers"));
  }
  std::vector<double> numbers;
  for (const toml::node& entry : *list) numbers.push_back(toml_number(entry, file, field));
  return numbers;
}

ParameterValue toml_parameter(const toml::node& node, const std::string& file, const std::string& field) {
  if (const auto* flag = node.as_boolean()) return flag->get();
  if (node.is_number()) return toml_number(node, file, field);
  if (const auto text = node.value<std::string>()) {
    if (const auto number = parse_hex_float(*text)) return *number;
    return *text;
  }
  const toml::array* const list = node.as_array();
  if (list == nullptr)
    throw UsageError(where(node, file, field) + "expected a number, true/false, a word or a list");
  if (list->empty() || !list->front().is_array()) return toml_numbers(node, file, field, 0);
  std::vector<std::vector<double>> rows;
  for (const toml::node& row : *list) rows.push_back(toml_numbers(row, file, field, 0));
  return rows;
}

}  // namespace graze
