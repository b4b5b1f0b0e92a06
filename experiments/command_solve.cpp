// graze solve and graze truth: rays in, hits out, one line a ray in the same order.
#include <algorithm>
#include <cmath>

#include <graze/experiments/truth.hpp>

#include "commands.hpp"
#include "errors.hpp"
#include "json_lines.hpp"

namespace graze {
namespace {

/// Options that solve and truth share.
struct StreamOptions {
  SceneOptions scene;
  std::string query = "all";
  std::string rays;
  bool keep_going = false;
  int jobs = 1;

  void add_to(CLI::App& command) {
    scene.add_to(command);
    add_query_option(command, query);
    command.add_flag("--keep-going", keep_going, "answer a bad line with status invalid and go on");
    add_jobs_option(command, jobs);
    command.add_option("RAYS", rays,
                       "JSON Lines {\"o\":[x,y,z],\"d\":[x,y,z]}; standard input if missing or -");
  }
};

/// Rays that one thread takes at a time.
constexpr std::size_t kShare = 512;

/// Reads, answers and writes batch by batch. `answer(rays, slot, out)` appends the lines of consecutive rays;
/// slot numbers the thread's share within the batch. Memory does not grow with the number of rays.
template <class Answer>
void stream(const StreamOptions& options, const Answer& answer) {
  LineReader reader(options.rays);
  JsonParser parser;
  Output output;
  RayBatch batch;
  std::optional<std::string> stop;
  std::vector<fmt::memory_buffer> parts(kBatch / kShare);
  while (!stop && read_batch(reader, parser, options.keep_going, batch, stop)) {
    const std::size_t shares = (batch.rays.size() + kShare - 1) / kShare;
    parallel_for(shares, options.jobs, [&](std::size_t slot) {
      parts[slot].clear();
      const std::size_t first = slot * kShare;
      const std::size_t count = std::min(kShare, batch.rays.size() - first);
      answer(std::span<const Ray>(batch.rays).subspan(first, count), first, batch, slot, parts[slot]);
    });
    for (std::size_t slot = 0; slot < shares; ++slot) {
      output.buffer().append(parts[slot]);
      output.write_if_large();
    }
    // A pipe's reader should not wait for the next batch.
    output.flush();
  }
  output.flush();
  if (stop) throw DataError(*stop);
}

/// The message of a bad line of the batch, or null.
const std::string* error_of(const RayBatch& batch, std::size_t index) {
  const auto found = std::lower_bound(batch.errors.begin(), batch.errors.end(), index,
                                      [](const auto& error, std::size_t i) { return error.first < i; });
  return found != batch.errors.end() && found->first == index ? &found->second : nullptr;
}

void append(fmt::memory_buffer& out, std::string_view text) {
  out.append(text.data(), text.data() + text.size());
}

void append_number(fmt::memory_buffer& out, double value) {
  fmt::format_to(std::back_inserter(out), "{}", value);
}

void append_vector(fmt::memory_buffer& out, Vec3 v) {
  out.push_back('[');
  append_number(out, v.x);
  out.push_back(',');
  append_number(out, v.y);
  out.push_back(',');
  append_number(out, v.z);
  out.push_back(']');
}

/// How a scene's surfaces call things in their hits.
struct HitNames {
  std::vector<std::array<std::string_view, 2>> params;
  std::vector<std::string> varieties;  ///< a quadric's class; empty for types without kinds

  explicit HitNames(const std::vector<SceneMember>& members) {
    for (const SceneMember& member : members) {
      const SurfaceEntry& entry = find_surface(member.surface.type);
      params.push_back(entry.info.params);
      varieties.emplace_back(entry.make(member.surface)->variety());
    }
  }
};

/// "surface":0, and its kind if it has one.
void append_surface(fmt::memory_buffer& out, std::size_t surface, const HitNames& names) {
  fmt::format_to(std::back_inserter(out), ",\"surface\":{}", surface);
  if (names.varieties[surface].empty()) return;
  append(out, ",\"variety\":");
  append_json_string(out, names.varieties[surface]);
}

/// {"t":...,"theta":...} with the surface's own names.
void append_params(fmt::memory_buffer& out, const std::array<std::string_view, 2>& names,
                   const std::array<double, 2>& values) {
  out.push_back('{');
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].empty()) continue;
    if (out.data()[out.size() - 1] != '{') out.push_back(',');
    append_json_string(out, names[i]);
    out.push_back(':');
    append_number(out, values[i]);
  }
  out.push_back('}');
}

void append_status(fmt::memory_buffer& out, Status status, std::string_view why) {
  append(out, "],\"status\":\"");
  append(out, to_string(status));
  out.push_back('"');
  if (!why.empty()) {
    append(out, ",\"why\":");
    append_json_string(out, why);
  }
  append(out, "}\n");
}

// --------------------------------------------------------------------------------------------------- solve

struct SolveOptions : StreamOptions {
  std::string solver = std::string(kDefaultSolver);
  std::string formulation;
  std::string precision = "double";
};

void append_hits(fmt::memory_buffer& out, const HitBuffer& hits, std::size_t ray, const HitNames& names) {
  append(out, "{\"hits\":[");
  for (std::size_t i = hits.begin(ray); i < hits.end(ray); ++i) {
    append(out, i == hits.begin(ray) ? "{\"l\":" : ",{\"l\":");
    append_number(out, hits.l[i]);
    append_surface(out, hits.surface[i], names);
    append(out, ",\"point\":");
    append_vector(out, hits.point[i]);
    append(out, ",\"normal\":");
    append_vector(out, hits.normal[i]);
    append(out, ",\"params\":");
    append_params(out, names.params[hits.surface[i]], hits.params[i]);
    fmt::format_to(std::back_inserter(out), ",\"multiplicity\":{}}}", hits.multiplicity[i]);
  }
}

void solve(const SolveOptions& options) {
  const std::vector<SceneMember> members = options.scene.members();
  SolverSpec solver = parse_solver(options.solver);
  solver.formulation = options.formulation;
  solver.precision = parse_precision(options.precision);
  const Scene scene = build_scene(members, solver);
  const HitNames names(members);
  const Query query = parse_query(options.query);

  struct Slot {
    Scene::Workspace work;
    HitBuffer hits;
  };
  std::vector<Slot> slots(kBatch / kShare);
  stream(options, [&](std::span<const Ray> rays, std::size_t first, const RayBatch& batch, std::size_t slot,
                      fmt::memory_buffer& out) {
    HitBuffer& hits = slots[slot].hits;
    hits.clear();
    scene.intersect(rays, query, {.points = true, .normals = true, .params = true}, slots[slot].work, hits);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      append_hits(out, hits, i, names);
      const std::string* const error = error_of(batch, first + i);
      append_status(out, hits.status[i], error != nullptr ? *error : "");
    }
  });
}

// --------------------------------------------------------------------------------------------------- truth

struct TruthOptions : StreamOptions {
  int digits = 40;
};

void append_truth(fmt::memory_buffer& out, const truth::Answer& answer, const HitNames& names) {
  append(out, "{\"hits\":[");
  for (std::size_t i = 0; i < answer.hits.size(); ++i) {
    const truth::Hit& hit = answer.hits[i];
    fmt::format_to(std::back_inserter(out), "{}{{\"l\":\"{}\"", i == 0 ? "" : ",", hit.l.decimal);
    append_surface(out, hit.surface, names);
    append(out, ",\"point\":");
    append_vector(out, hit.point);
    append(out, ",\"normal\":");
    append_vector(out, hit.normal);
    append(out, ",\"params\":");
    append_params(out, names.params[hit.surface], hit.params);
    fmt::format_to(std::back_inserter(out),
                   ",\"multiplicity\":{},\"enclosure\":[\"{}\",\"{}\"],\"tangent\":{}}}", hit.multiplicity,
                   hit.l.lo, hit.l.hi, hit.tangent);
  }
}

std::vector<std::unique_ptr<truth::Surface>> build_truth(const std::vector<SceneMember>& members) {
  std::vector<std::unique_ptr<truth::Surface>> scene;
  for (const SceneMember& member : members) {
    try {
      scene.push_back(truth::make_surface(member.surface));
    } catch (const std::invalid_argument& error) {
      throw UsageError(error.what());
    }
  }
  return scene;
}

void tell_truth(const TruthOptions& options) {
  const std::vector<SceneMember> members = options.scene.members();
  const auto scene = build_truth(members);
  const HitNames names(members);
  const bool first_only = options.query != "all";
  stream(options, [&](std::span<const Ray> rays, std::size_t first, const RayBatch& batch,
                      std::size_t /*slot*/, fmt::memory_buffer& out) {
    for (std::size_t i = 0; i < rays.size(); ++i) {
      truth::Answer answer;
      if (is_valid(rays[i])) {
        answer = truth::all_hits(scene, rays[i], {.digits = options.digits});
      } else {
        answer.status = Status::invalid;
      }
      if (first_only && answer.hits.size() > 1) answer.hits.resize(1);
      append_truth(out, answer, names);
      const std::string* const error = error_of(batch, first + i);
      append_status(out, answer.status, error != nullptr ? *error : answer.why);
    }
  });
}

}  // namespace

Action add_solve_command(CLI::App& app) {
  CLI::App* const command = app.add_subcommand("solve", "hits of rays, by one solver");
  const auto options = std::make_shared<SolveOptions>();
  options->add_to(*command);
  command
      ->add_option("--solver", options->solver,
                   "solver with options: newton_slices:tries=50 (see graze list; default certified)")
      ->type_name("NAME[:key=value,...]");
  command
      ->add_option("--formulation", options->formulation,
                   "equation to solve (default: the solver's preference)")
      ->type_name("NAME");
  add_precision_option(*command, options->precision);
  return [options] { solve(*options); };
}

Action add_truth_command(CLI::App& app) {
  CLI::App* const command =
      app.add_subcommand("truth", "certified hits of rays, proved, as decimals with enclosures");
  const auto options = std::make_shared<TruthOptions>();
  options->add_to(*command);
  command->add_option("--digits", options->digits, "significant decimal digits (default 40)")
      ->check(CLI::Range(17, 100000));
  return [options] { tell_truth(*options); };
}

}  // namespace graze
