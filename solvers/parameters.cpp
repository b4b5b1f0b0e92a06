#include <graze/solvers/parameters.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace graze {
namespace {

[[noreturn]] void fail(const std::string& message) { throw std::invalid_argument(message); }

double finite(double value, const std::string& name) {
  if (!std::isfinite(value)) fail("parameter '" + name + "' is not finite");
  return value;
}

/// Levenshtein distance by rows.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replace = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replace, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

const ParameterValue& Parameters::at(const std::string& name) const {
  const auto found = values_.find(name);
  if (found == values_.end()) fail("parameter '" + name + "' is missing");
  return found->second;
}

double Parameters::number(const std::string& name) const {
  const auto* value = std::get_if<double>(&at(name));
  if (value == nullptr) fail("parameter '" + name + "' must be a number");
  return finite(*value, name);
}

double Parameters::number(const std::string& name, double fallback) const {
  return has(name) ? number(name) : fallback;
}

int Parameters::integer(const std::string& name, int fallback, int lo, int hi) const {
  const double value = number(name, fallback);
  if (value != std::floor(value) || value < lo || value > hi) {
    fail("parameter '" + name + "' must be a whole number from " + std::to_string(lo) + " to " +
         std::to_string(hi));
  }
  return static_cast<int>(value);
}

bool Parameters::flag(const std::string& name, bool fallback) const {
  if (!has(name)) return fallback;
  const auto* value = std::get_if<bool>(&at(name));
  if (value == nullptr) fail("parameter '" + name + "' must be true or false");
  return *value;
}

std::string Parameters::word(const std::string& name, const std::string& fallback) const {
  if (!has(name)) return fallback;
  const auto* value = std::get_if<std::string>(&at(name));
  if (value == nullptr) fail("parameter '" + name + "' must be a word");
  return *value;
}

std::vector<double> Parameters::list(const std::string& name, std::size_t size) const {
  const auto* value = std::get_if<std::vector<double>>(&at(name));
  if (value == nullptr || value->size() != size) {
    fail("parameter '" + name + "' must be a list of " + std::to_string(size) + " numbers");
  }
  for (const double entry : *value) finite(entry, name);
  return *value;
}

std::vector<double> Parameters::list(const std::string& name, std::size_t size,
                                     const std::vector<double>& fallback) const {
  return has(name) ? list(name, size) : fallback;
}

std::vector<std::vector<double>> Parameters::table(const std::string& name, std::size_t columns) const {
  const auto* value = std::get_if<std::vector<std::vector<double>>>(&at(name));
  if (value == nullptr) fail("parameter '" + name + "' must be a list of rows of numbers");
  for (std::size_t i = 0; i < value->size(); ++i) {
    const std::string where = name + "[" + std::to_string(i) + "]";
    if ((*value)[i].size() != columns) fail(where + " must hold " + std::to_string(columns) + " numbers");
    for (const double entry : (*value)[i]) finite(entry, where);
  }
  return *value;
}

void Parameters::expect_only(std::span<const std::string_view> known, std::string_view owner) const {
  for (const auto& [name, value] : values_) {
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      fail(unknown_name_message("parameter of " + std::string(owner), name, known));
    }
  }
}

std::vector<std::string> nearest_names(std::string_view name, std::span<const std::string_view> known) {
  std::vector<std::pair<std::size_t, std::string>> ranked;
  for (const auto candidate : known) ranked.emplace_back(edit_distance(name, candidate), candidate);
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> nearest;
  for (std::size_t i = 0; i < ranked.size() && i < 3; ++i) nearest.push_back(ranked[i].second);
  return nearest;
}

std::string unknown_name_message(std::string_view what, std::string_view name,
                                 std::span<const std::string_view> known) {
  std::string message = "unknown " + std::string(what) + " '" + std::string(name) + "'";
  const auto nearest = nearest_names(name, known);
  for (std::size_t i = 0; i < nearest.size(); ++i) message += (i == 0 ? " (nearest: " : ", ") + nearest[i];
  return nearest.empty() ? message + " (there are none)" : message + ")";
}

}  // namespace graze
