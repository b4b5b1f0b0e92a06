#include <graze/solvers/solver.hpp>

namespace graze {

std::string_view to_string(Status status) {
  switch (status) {
    case Status::ok:
      return "ok";
    case Status::uncertain:
      return "uncertain";
    case Status::failed:
      return "failed";
    case Status::coincident:
      return "coincident";
    case Status::invalid:
      return "invalid";
  }
  return "?";
}

std::string_view to_string(Form form) {
  switch (form) {
    case Form::polynomial:
      return "polynomial";
    case Form::scalar:
      return "scalar";
    case Form::interval:
      return "interval";
    case Form::system:
      return "system";
  }
  return "?";
}

std::string_view to_string(Precision precision) {
  return precision == Precision::binary64 ? "double" : "float";
}

}  // namespace graze
