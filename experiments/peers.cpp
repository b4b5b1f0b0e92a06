#include "peers.hpp"

#include <stdexcept>
#include <string>

#include <graze/surfaces/registry.hpp>

namespace graze {
namespace {

constexpr std::string_view kPrefix = "peer:";

const Peer* find_peer(std::string_view name) {
  for (const Peer& peer : peer_registry()) {
    if (peer.solver.name == name) return &peer;
  }
  return nullptr;
}

}  // namespace

std::vector<const SolverEntry*> solvers_and_peers() {
  std::vector<const SolverEntry*> entries;
  for (const SolverEntry& entry : solver_registry()) entries.push_back(&entry);
  for (const Peer& peer : peer_registry()) entries.push_back(&peer.solver);
  return entries;
}

const SolverEntry& find_solver_or_peer(std::string_view name) {
  if (name.substr(0, kPrefix.size()) != kPrefix) return find_solver(name);
  if (const Peer* const peer = find_peer(name)) return peer->solver;
  if (peer_registry().empty()) {
    throw std::invalid_argument(
        "unknown solver '" + std::string(name) +
        "': this build has no peers; ./dev bench, or cmake -DGRAZE_PEERS=ON, makes one that has");
  }
  std::vector<std::string_view> known;
  for (const Peer& peer : peer_registry()) known.push_back(peer.solver.name);
  throw std::invalid_argument(unknown_name_message("solver", name, known) +
                              "; -DGRAZE_PEERS=ON builds a peer where its package is found");
}

SurfaceEntry seen_by(const SolverEntry& solver, const SurfaceEntry& surface, Query query) {
  const Peer* const peer = find_peer(solver.name);
  return peer != nullptr && peer->seen != nullptr ? peer->seen(surface, query) : surface;
}

}  // namespace graze
