// Peers: solvers that other people wrote, to measure against; empty unless built with -DGRAZE_PEERS=ON
// (experiments/peers/). They are no part of the registry: experiments and contract tests do not see them.
#pragma once

#include <string_view>
#include <vector>

#include <graze/solvers/solver.hpp>
#include <graze/surfaces/hit.hpp>
#include <graze/surfaces/surface.hpp>

namespace graze {

struct Peer {
  SolverEntry solver;
  /// The surface as the peer sees it for a query: its own formulation and kernel, for peers that take rays.
  /// Null for root finders, which see what our own solvers see.
  SurfaceEntry (*seen)(SurfaceEntry surface, Query query) = nullptr;
};

/// The entry of method P; one that takes rays has P::seen.
template <Solver P>
Peer peer_entry(std::string_view name) {
  Peer peer;
  peer.solver = solver_entry<P>(name);
  if constexpr (requires { &P::seen; }) peer.seen = &P::seen;
  return peer;
}

/// Every peer of this build, in list order; generated.
const std::vector<Peer>& peer_registry();

/// The registry's solvers, then the peers.
std::vector<const SolverEntry*> solvers_and_peers();

/// The registry's solver or the peer of this name; throws std::invalid_argument that names the nearest ones,
/// and for a peer how to get it.
const SolverEntry& find_solver_or_peer(std::string_view name);

/// The surface as `solver` sees it.
SurfaceEntry seen_by(const SolverEntry& solver, const SurfaceEntry& surface, Query query);

}  // namespace graze
