// What can go wrong for a user of the program, by exit code (DESIGN: 2 usage, 3 data, 4 environment, 130).
#pragma once

#include <stdexcept>
#include <string>

namespace graze {

/// An error that ends the program with an exit code after its message.
class ProgramError : public std::runtime_error {
 public:
  ProgramError(int code, const std::string& message) : std::runtime_error(message), code_(code) {}
  [[nodiscard]] int code() const { return code_; }

 private:
  int code_;
};

/// Wrong usage or configuration.
struct UsageError : ProgramError {
  explicit UsageError(const std::string& message) : ProgramError(2, message) {}
};
/// Bad input data; the message names file, line and field.
struct DataError : ProgramError {
  explicit DataError(const std::string& message) : ProgramError(3, message) {}
};
/// Input or output that fails, a component that is missing.
struct EnvironmentError : ProgramError {
  explicit EnvironmentError(const std::string& message) : ProgramError(4, message) {}
};
/// Ctrl-C: what was finished is kept.
struct Interrupted : ProgramError {
  explicit Interrupted(const std::string& message) : ProgramError(130, message) {}
};

}  // namespace graze
