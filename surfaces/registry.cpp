#include <graze/surfaces/registry.hpp>

#include <stdexcept>

namespace graze {
namespace {

template <class Entry>
const Entry& find_entry(const std::vector<Entry>& entries, std::string_view what, std::string_view name) {
  std::vector<std::string_view> known;
  for (const Entry& entry : entries) {
    if (entry.name == name) return entry;
    known.push_back(entry.name);
  }
  throw std::invalid_argument(unknown_name_message(what, name, known));
}

}  // namespace

const SolverEntry& find_solver(std::string_view name) {
  return find_entry(solver_registry(), "solver", name);
}
const SurfaceEntry& find_surface(std::string_view name) {
  return find_entry(surface_registry(), "surface", name);
}

}  // namespace graze
