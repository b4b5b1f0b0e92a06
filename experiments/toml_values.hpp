// TOML values as graze's parameters, with errors that name file, line and field. toml++ is compiled once,
// in toml_values.cpp.
#pragma once

#include <string>
#include <string_view>

#define TOML_HEADER_ONLY 0
#include <toml++/toml.h>

#include <graze/solvers/parameters.hpp>

namespace graze {

/// Parses a file; UsageError names file and line.
toml::table parse_toml_file(const std::string& path);
/// Parses text that came from `origin` (a name for messages).
toml::table parse_toml(std::string_view text, const std::string& origin);

/// "FILE:LINE: field 'NAME': " for a node, or "FILE: " where the line is not known.
std::string where(const toml::node& node, const std::string& file, const std::string& field);

/// A number: TOML integer or float, or a hex-float string such as "0x1.8p+1".
double toml_number(const toml::node& node, const std::string& file, const std::string& field);
/// A list of exactly `count` numbers (any number when 0).
std::vector<double> toml_numbers(const toml::node& node, const std::string& file, const std::string& field,
                                 std::size_t count);
/// Any value a parameter may have.
ParameterValue toml_parameter(const toml::node& node, const std::string& file, const std::string& field);

}  // namespace graze
