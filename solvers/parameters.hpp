// Named parameters of a surface or a solver, as they come from a command line or a scene file.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace graze {

/// A value as a text format gives it: a number, a switch, a word, a list or a table of numbers.
using ParameterValue =
    std::variant<double, bool, std::string, std::vector<double>, std::vector<std::vector<double>>>;

/// Name -> value. Every reader throws std::invalid_argument with a sentence that names the parameter;
/// `expect_only` names the nearest known parameter when an unknown one was given.
class Parameters {
 public:
  Parameters() = default;
  explicit Parameters(std::map<std::string, ParameterValue> values) : values_(std::move(values)) {}

  void set(const std::string& name, ParameterValue value) { values_[name] = std::move(value); }
  [[nodiscard]] bool has(const std::string& name) const { return values_.count(name) != 0; }
  [[nodiscard]] const std::map<std::string, ParameterValue>& values() const { return values_; }

  /// A finite number. Without `fallback` the parameter must be there.
  [[nodiscard]] double number(const std::string& name) const;
  [[nodiscard]] double number(const std::string& name, double fallback) const;
  /// A whole number in [lo, hi].
  [[nodiscard]] int integer(const std::string& name, int fallback, int lo, int hi) const;
  [[nodiscard]] bool flag(const std::string& name, bool fallback) const;
  [[nodiscard]] std::string word(const std::string& name, const std::string& fallback) const;
  /// A list of `size` finite numbers, such as center = [x, y, z].
  [[nodiscard]] std::vector<double> list(const std::string& name, std::size_t size) const;
  [[nodiscard]] std::vector<double> list(const std::string& name, std::size_t size,
                                         const std::vector<double>& fallback) const;
  /// A table of numbers with `columns` finite entries in every row, such as [[r,y],...].
  [[nodiscard]] std::vector<std::vector<double>> table(const std::string& name, std::size_t columns) const;

  void expect_only(std::span<const std::string_view> known, std::string_view owner) const;

 private:
  [[nodiscard]] const ParameterValue& at(const std::string& name) const;
  std::map<std::string, ParameterValue> values_;
};

/// The up to three names of `known` that are nearest to `name` by edit distance, for messages such as
/// "unknown solver 'compnion' (nearest: companion)". Cost O(|known| |name|^2).
std::vector<std::string> nearest_names(std::string_view name, std::span<const std::string_view> known);

/// "unknown WHAT 'NAME' (nearest: a, b)".
std::string unknown_name_message(std::string_view what, std::string_view name,
                                 std::span<const std::string_view> known);

}  // namespace graze
