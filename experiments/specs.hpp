// Surfaces, solvers and scenes as text: the command line's "NAME:key=value,..." and scene files in TOML.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <graze/surfaces/intersector.hpp>
#include <graze/surfaces/registry.hpp>

namespace graze {

/// The solver of every command that takes one, unless another is named.
inline constexpr std::string_view kDefaultSolver = "certified";

/// "companion:polish=true": a registry name with options.
struct SolverSpec {
  std::string name;
  Parameters options;
  std::string options_text;  ///< "polish=true", empty for the defaults
  std::string formulation;   ///< empty: the solver's preference
  Precision precision = Precision::binary64;
};

/// A surface of a scene with what the file says about how to solve it.
struct SceneMember {
  SurfaceSpec surface;
  std::string solver;       ///< empty: the command line's
  std::string formulation;  ///< empty: the command line's, or the solver's preference
};

/// "teardrop:s=1", "bezier_revolution:control_points=[[0,0],[2,0]]". Throws UsageError.
SurfaceSpec parse_surface(std::string_view text);
/// The inverse, shortest round-trip numbers: the label under which records are kept.
std::string surface_label(const SurfaceSpec& spec);
/// "newton_slices:tries=50". Throws UsageError; the name is checked against the registry.
SolverSpec parse_solver(std::string_view text);
/// "A,B:x=1,y=2,C": a comma starts a new solver unless a key=value follows it. Takes peers too ("peer:gsl").
std::vector<SolverSpec> parse_solver_list(std::string_view text);

/// Reads a scene file. Throws UsageError that names file, line and field.
std::vector<SceneMember> read_scene(const std::string& path);

/// Builds the scene's intersectors: each member's own solver, or `solver`, which may be a peer. A peer that
/// takes rays is made for `query`.
Scene build_scene(std::span<const SceneMember> members, const SolverSpec& solver, Query query = Query::all);

/// The spec with every length multiplied by `factor`.
SurfaceSpec scaled(const SurfaceSpec& spec, double factor);

}  // namespace graze
