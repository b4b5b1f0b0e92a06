// shards: 2, also slow
// An adversary against the solvers that promise never to be wrong: random rays of every family, structured
// rays, hill-climbing towards large errors and narrow decisions, and walks along the edge between rays of
// different counts, each ray against exact truth. Surfaces: the contract's examples, hard and random ones.
// A counter-example is printed as a line for tests/data/surfaces_open.jsonl; mended, it moves to
// surfaces_hard.jsonl.
//
// GRAZE_SECONDS=60  search for so long, per type of surface (default: a fixed number of rounds; a minute with
//                   GRAZE_LONG, as the label slow sets it)
// GRAZE_SEED=7      other rays
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <initializer_list>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <graze/experiments/cases.hpp>
#include <graze/experiments/judge.hpp>
#include <graze/experiments/numbers.hpp>
#include <graze/experiments/specs.hpp>
#include <graze/experiments/truth.hpp>
#include <surfaces/cells.hpp>

#include "attack_rays.hpp"
#include "attack_surfaces.hpp"
#include "family_rays.hpp"

namespace graze::test {
namespace {

std::uint64_t number_from(const char* name, std::uint64_t fallback) {
  const char* const text = std::getenv(name);
  return text == nullptr ? fallback : std::strtoull(text, nullptr, 10);
}
std::uint64_t seed() { return number_from("GRAZE_SEED", 20261122); }

double seconds_asked() {
  const bool is_long = std::getenv("GRAZE_LONG") != nullptr;
  return static_cast<double>(number_from("GRAZE_SECONDS", is_long ? 60 : 0));
}

// ----------------------------------------------------------------------------------------------- one answer

/// What is wrong with an answer. Merged: hits nearer than doubles are one claim of their multiplicity
/// together, which the judge of experiments takes for right; here only where doubles are fewer than hits.
enum class Fault { none, undecided, status, count, merged, multiplicity, error };
constexpr std::array<const char*, 7> kFaults{"none",   "undecided",    "status", "count",
                                             "merged", "multiplicity", "error"};

struct Finding {
  Fault fault = Fault::none;
  std::string words;
  double error = 0;  ///< largest, in units of the bound
};

/// Whether doubles hold the answer: every l a normal number.
bool is_in_range(const truth::Answer& truth) {
  return std::all_of(truth.hits.begin(), truth.hits.end(), [](const truth::Hit& hit) {
    return std::isfinite(hit.l.head) && hit.l.head >= std::numeric_limits<double>::min();
  });
}

/// The largest error of the hits, as a share of the bound. A shadow ray may tell any hit.
double largest_error(const Promise& promise, const Ray& ray, const truth::Answer& truth, const HitBuffer& got,
                     Query query, double size) {
  double largest = 0;
  for (std::size_t k = 0; k < got.l.size(); ++k) {
    double error = promise.share(got.l[k], truth.hits[k], ray, size);
    for (std::size_t j = 0; query == Query::any && j < truth.hits.size(); ++j)
      error = std::min(error, promise.share(got.l[k], truth.hits[j], ray, size));
    // An error that is no number is the worst.
    if (!(error <= largest)) largest = error;
  }
  return largest;
}

/// The largest double that is no greater than the exact l, or the smallest that is no less.
double double_beside(const truth::Hit& hit, double sense) {
  const bool is_beyond = sense * hit.l.tail > 0;
  return is_beyond ? std::nextafter(hit.l.head, sense * std::numeric_limits<double>::infinity()) : hit.l.head;
}

/// Whether some hits are more than the doubles within an ulp of them, or three have two nearest doubles:
/// these are joined (solvers/faithful.md). Two hits never are.
bool is_crowded(const truth::Answer& truth) {
  for (std::size_t i = 0; i < truth.hits.size(); ++i) {
    for (std::size_t j = i + 2; j < truth.hits.size(); ++j) {
      const double first = double_beside(truth.hits[i], -1), last = double_beside(truth.hits[j], 1);
      if (truth.hits[j].l.head <= std::nextafter(truth.hits[i].l.head, last)) return true;
      if (place_of(last) - place_of(first) < static_cast<std::int64_t>(j - i)) return true;
    }
  }
  return false;
}

/// Another count than truth's.
Finding miscount(const Ray& ray, const truth::Answer& truth, const HitBuffer& got, double size) {
  const Claim claim{got.status[0], got.l, {}, {}, got.multiplicity};
  const bool is_merged = judge(ray, truth, claim, {.size = size}, nullptr).verdict == Verdict::right;
  if (is_merged && is_crowded(truth)) return {};
  return {is_merged ? Fault::merged : Fault::count,
          fmt::format("{} hits, truth {}", got.l.size(), truth.hits.size())};
}

/// The answer of one ray, alone in the buffer, to a query. `size` is L.
Finding judge_answer(const Promise& promise, const Ray& ray, const truth::Answer& truth, const HitBuffer& got,
                     Query query, double size) {
  const Status status = got.status[0];
  const std::string said(to_string(status));
  if (status == Status::uncertain || status == Status::failed) return {Fault::undecided, said};
  if (status != truth.status)
    return {Fault::status, fmt::format("{}, truth {}", said, to_string(truth.status))};
  if (status != Status::ok) return {};
  const std::size_t wanted =
      query == Query::all ? truth.hits.size() : std::min<std::size_t>(1, truth.hits.size());
  if (got.l.size() != wanted) return miscount(ray, truth, got, size);
  const double error = largest_error(promise, ray, truth, got, query, size);
  if (!(error <= 1)) {
    return {Fault::error, fmt::format("l is off by {:.3g} {}", error * promise.bound, promise.unit()), error};
  }
  for (std::size_t k = 0; k < wanted && query != Query::any; ++k) {
    const std::uint32_t claimed = got.multiplicity[k], true_one = truth.hits[k].multiplicity;
    if (claimed != true_one)
      return {Fault::multiplicity, fmt::format("multiplicity {}, truth {}", claimed, true_one), error};
  }
  return {Fault::none, "", error};
}

// ----------------------------------------------------------------------------------------------- one surface

constexpr unsigned set_of(std::initializer_list<Fault> faults) {
  unsigned set = 0;
  for (const Fault fault : faults) set |= 1U << static_cast<unsigned>(fault);
  return set;
}

/// Flaws that are known and open: counted and printed, not held against the solver. Rows go as they are
/// mended; there is none left.
struct Known {
  std::string_view type;
  unsigned on_any = 0;
  unsigned on_wild = 0;  ///< on rays with numbers that are all but zero or very large
};
constexpr std::array<Known, 0> kKnown{};

/// Numbers whose products may leave the range of normal doubles.
bool is_wild(Ray ray) {
  constexpr int kTame = 200;
  for (std::size_t i = 0; i < kNumbers; ++i) {
    const double x = number(ray, i);
    if (x != 0 && std::abs(std::ilogb(x)) > kTame) return true;
  }
  return false;
}

std::string list_of(Vec3 v) {
  return fmt::format("[\"{}\", \"{}\", \"{}\"]", hex_float(v.x), hex_float(v.y), hex_float(v.z));
}

/// A solver under attack.
struct Contender {
  Promise promise;
  Scene scene;
  Scene::Workspace work;
  HitBuffer hits;
};

/// What came of all rays of a solver on one type of surface.
struct Tally {
  std::map<std::string, std::size_t> faults;  ///< by kind
  double error = 0;                           ///< worst, in units of the bound
};
struct Totals {
  std::size_t rays = 0, wrong = 0;
  std::map<std::string_view, Tally> of;
};

/// What a search sees of a ray.
struct Sighting {
  Ray ray;
  std::size_t hits = 0;
  unsigned tiers = 0;  ///< which arithmetic answered, all solvers together
  double error = 0;    ///< largest of the solvers', in units of their bounds
  double margin = 1;   ///< smallest distance of the truth from another one, relative
};

/// A surface, its truth, and the solvers that are asked about it.
class Target {
 public:
  Target(const SurfaceSpec& spec, std::string origin, Totals& totals)
      : spec_(spec),
        origin_(std::move(origin)),
        surface_(find_surface(spec.type).make(spec)),
        truth_(truth::make_surface(spec)),
        totals_(&totals) {
    for (const Promise& promise : kPromises) {
      const SolverEntry* const solver = solver_named(promise.solver);  // the build may lack it
      if (solver == nullptr || all_pairings(*solver, find_surface(spec.type)).empty()) continue;
      contenders_.push_back({promise, scene_of(spec, *solver), {}, {}});
    }
  }

  [[nodiscard]] const AnySurface& surface() const { return *surface_; }

  /// Asks truth and every solver; notes what is wrong.
  Sighting ask(const Ray& ray) {
    const truth::Answer truth = truth_->all(ray, {.digits = 20});
    ++totals_->rays;
    Sighting sighting{ray, truth.hits.size(), 0, 0, margin_of(ray, truth)};
    for (Contender& contender : contenders_) {
      for (const Query query : {Query::all, Query::first, Query::any}) {
        const Finding finding = answer(contender, ray, truth, query);
        sighting.error = std::max(sighting.error, finding.error);
        sighting.tiers = 8 * sighting.tiers + contender.hits.counters[0].tier;
        note(contender, ray, query, finding);
        if (finding.fault != Fault::none) break;
      }
    }
    return sighting;
  }

 private:
  [[nodiscard]] double lever(const Ray& ray) const { return surface_->size() / norm(ray.d); }

  [[nodiscard]] double margin_of(const Ray& ray, const truth::Answer& truth) const {
    double margin = 1;
    double before = 0;
    for (const truth::Hit& hit : truth.hits) {
      const double gap = (hit.l.head - before) / (std::fabs(hit.l.head) + lever(ray));
      margin = std::min({margin, gap, hit.multiplicity > 1 ? 1 : hit.cosine});
      before = hit.l.head;
    }
    return margin;
  }

  Finding answer(Contender& contender, const Ray& ray, const truth::Answer& truth, Query query) const {
    contender.hits.clear();
    contender.scene.intersect({&ray, 1}, query, {}, contender.work, contender.hits);
    // Where doubles cannot hold the answer, none is as good as any.
    if (!is_in_range(truth)) return {};
    return judge_answer(contender.promise, ray, truth, contender.hits, query, surface_->size());
  }

  [[nodiscard]] bool is_known(Fault fault, bool wild) const {
    return std::any_of(kKnown.begin(), kKnown.end(), [&](const Known& known) {
      const unsigned faults = known.on_any | (wild ? known.on_wild : 0);
      return known.type == spec_.type && (faults & set_of({fault})) != 0;
    });
  }

  void note(Contender& contender, const Ray& ray, Query query, const Finding& finding) {
    constexpr std::size_t kShown = 3;  // of a kind: a climb finds a flaw again and again
    Tally& tally = totals_->of[contender.promise.solver];
    tally.error = std::max(tally.error, finding.error);
    if (finding.fault == Fault::none) return;
    const bool known = is_known(finding.fault, is_wild(ray));
    const std::string kind = fmt::format("{}{}{}", known ? "known " : "", is_wild(ray) ? "wild " : "",
                                         kFaults[static_cast<std::size_t>(finding.fault)]);
    const bool is_shown = ++tally.faults[kind] <= kShown;
    if (!known) ++totals_->wrong;
    if (is_shown && !known)
      ADD_FAILURE() << line_of(contender, shrunk(contender, ray, query, finding.fault), query);
  }

  /// The same fault by numbers of fewer bits.
  Ray shrunk(Contender& contender, Ray ray, Query query, Fault fault) const {
    const auto still_wrong = [&](const Ray& simpler) {
      return is_valid(simpler) && is_wild(simpler) == is_wild(ray) &&
             answer(contender, simpler, truth_->all(simpler, {.digits = 20}), query).fault == fault;
    };
    for (std::size_t i = 0; i < kNumbers; ++i) {
      for (const int bits : {-1, 0, 1, 2, 4, 8, 16, 24, 32, 40}) {
        Ray simpler = ray;
        double& x = number(simpler, i);
        x = bits < 0 ? 0 : cut(x, bits);
        if (!still_wrong(simpler)) continue;
        ray = simpler;
        break;
      }
    }
    return ray;
  }

  std::string line_of(Contender& contender, const Ray& ray, Query query) const {
    const truth::Answer truth = truth_->all(ray, {});
    const Finding finding = answer(contender, ray, truth, query);
    std::string digits;
    for (const truth::Hit& hit : truth.hits)
      digits += fmt::format("{}\"{}\"", digits.empty() ? "" : ", ", hit.l.decimal);
    constexpr std::array<const char*, 3> kQueries{"all", "first", "any"};
    return fmt::format(
        "{{\"o\": {}, \"d\": {}, \"surface\": \"{}\", \"origin\": \"adversarial search, {}: {}, query {}: "
        "{}\", \"truth\": [{}]}}",
        list_of(ray.o), list_of(ray.d), surface_label(spec_), origin_, contender.promise.solver,
        kQueries[static_cast<std::size_t>(query)], finding.words, digits);
  }

  SurfaceSpec spec_;
  std::string origin_;
  std::unique_ptr<AnySurface> surface_;
  std::unique_ptr<truth::Surface> truth_;
  std::vector<Contender> contenders_;
  Totals* totals_;
};

// ---------------------------------------------------------------------------------------------- the searches

/// Rays of a family, from a block that no other round has.
std::vector<Ray> family_rays(const Target& target, std::size_t round, std::size_t count) {
  std::vector<Ray> rays;
  for (const CaseFamily& family : case_families()) {
    if (!family.suits(target.surface().landmarks())) continue;
    for (const CaseRay& ray : make_block(family, target.surface(), seed(), round, count))
      rays.push_back(ray.ray);
  }
  return rays;
}

/// From a ray uphill: towards larger errors, or towards a narrower decision.
void climb(Target& target, const Ray& start, bool to_errors, std::size_t steps, Rng& rng) {
  const auto height = [to_errors](const Sighting& s) { return to_errors ? s.error : -s.margin; };
  Sighting best = target.ask(start);
  for (std::size_t i = 0; i < steps; ++i) {
    const Ray ray = moved(best.ray, target.surface().size(), rng);
    if (!is_valid(ray)) continue;
    const Sighting next = target.ask(ray);
    if (next.hits > 0 && height(next) >= height(best)) best = next;
  }
}

/// What changes across an edge: the count of hits, or the arithmetic that a solver's filters let answer.
enum class Side { count, tier };
unsigned side_of(Side side, const Sighting& s) {
  return side == Side::count ? static_cast<unsigned>(s.hits) : s.tiers;
}

/// Two rays that differ in one number, by one ulp, and lie on two sides.
struct Edge {
  Ray one, other;
};

/// Between two rays on two sides that differ in the number `i` only.
Edge bisect(Target& target, Side side, Ray one, Ray other, std::size_t i) {
  const unsigned here = side_of(side, target.ask(one));
  while (true) {
    const double a = number(one, i);
    const double b = number(other, i);
    const double middle = a + 0.5 * (b - a);
    const double least = least_step(one, i, target.surface().size());
    if (middle == a || middle == b || std::fabs(b - a) < least) return {one, other};
    Ray between = one;
    number(between, i) = middle;
    if (!is_valid(between)) return {one, other};
    (side_of(side, target.ask(between)) == here ? one : other) = between;
  }
}

/// From one ray to the other, number by number, to the first change.
std::optional<Edge> edge_between(Target& target, Side side, Ray one, Ray other) {
  const unsigned here = side_of(side, target.ask(one));
  for (std::size_t i = 0; i < kNumbers; ++i) {
    Ray next = one;
    number(next, i) = number(other, i);
    if (!is_valid(next)) return std::nullopt;
    if (side_of(side, target.ask(next)) != here) return bisect(target, side, one, next, i);
    one = next;
  }
  return std::nullopt;
}

/// The edge next to a ray near it: steps of 1, 2, 4, ... ulps either way until the side changes.
std::optional<Edge> edge_near(Target& target, Side side, const Ray& ray, Rng& rng) {
  constexpr int kDoublings = 30;
  const std::size_t i = pick(rng, kNumbers);
  const unsigned here = side_of(side, target.ask(ray));
  for (int k = 0; k < kDoublings; ++k) {
    for (const double sign : {-1.0, 1.0}) {
      Ray next = ray;
      step_aside(next, i, std::ldexp(sign, k), target.surface().size());
      if (is_valid(next) && side_of(side, target.ask(next)) != here)
        return bisect(target, side, ray, next, i);
    }
  }
  return std::nullopt;
}

/// Along the edge: a few ulps beside it, and from time to time to where a larger move finds it again.
void walk_edge(Target& target, Side side, Edge edge, std::size_t steps, Rng& rng) {
  for (std::size_t i = 0; i < steps; ++i) {
    const Ray& from = chance(rng, 0.5) ? edge.one : edge.other;
    const bool is_far = chance(rng, 0.125);
    const double size = target.surface().size();
    const Ray ray = is_far ? moved(from, size, rng) : nudged(from, size, rng);
    if (!is_valid(ray)) continue;
    target.ask(ray);
    if (!is_far) continue;
    if (const auto next = edge_near(target, side, ray, rng)) edge = *next;
  }
}

/// How many rays of each kind a round takes.
struct Effort {
  std::size_t of_family, structured, searches, steps;
};
/// Of the one round of a short run, all surfaces together in some seconds; and of each round of a long one.
constexpr Effort kShort = kSanitized ? Effort{1, 10, 1, 5} : Effort{2, 100, 4, 30};
constexpr Effort kLong{10, 200, 4, 60};

/// One round against one surface: each ingredient in its turn.
void attack(Target& target, std::size_t round, const Effort& effort, Rng& rng) {
  std::vector<Ray> rays = family_rays(target, round, effort.of_family);
  for (std::size_t i = 0; i < effort.structured; ++i) rays.push_back(structured_ray(target.surface(), rng));
  for (const Ray& ray : rays) target.ask(ray);
  // Searches from rays with numbers out of the ordinary take long, and stay there.
  const auto any_ray = [&]() -> const Ray& {
    const Ray* ray = nullptr;
    for (int i = 0; i < 4 && (ray == nullptr || is_wild(*ray)); ++i) ray = &rays[pick(rng, rays.size())];
    return *ray;
  };
  for (std::size_t i = 0; i < effort.searches; ++i) {
    climb(target, any_ray(), true, effort.steps, rng);
    climb(target, any_ray(), false, effort.steps, rng);
    const Ray& one = any_ray();
    const Ray& other = any_ray();
    for (const Side side : {Side::count, Side::tier}) {
      // From the edge of the count it is not far to where the filters give up.
      const auto edge = edge_between(target, side, one, other);
      if (edge) walk_edge(target, side, *edge, effort.steps, rng);
    }
  }
}

/// Where a round's surface comes from: the list in its turn; each third time round, a random or scaled one.
SurfaceSpec surface_of(std::string_view type, std::size_t round, std::size_t turn, const SurfaceSpec& listed,
                       Rng& rng) {
  if ((round + turn) % 3 != 2) return listed;
  if (chance(rng, 0.5)) {
    if (const auto spec = random_surface(type, rng)) return *spec;
  }
  const double factor = chance(rng, 0.5) ? std::ldexp(1.0, whole(rng, 100)) : std::exp(rng.uniform(-20, 20));
  return graze::scaled(listed, factor);
}

class Attack : public testing::TestWithParam<std::string_view> {};

void print(std::string_view type, const Totals& totals, std::size_t rounds, double seconds) {
  for (const auto& [solver, tally] : totals.of) {
    std::string faults;
    for (const auto& [kind, count] : tally.faults) faults += fmt::format(", {} {}", count, kind);
    fmt::print("{:20} {:10} seed {}: {} rays in {} rounds, {:.1f} s, worst error {:.3g} of the bound{}\n",
               type, solver, seed(), totals.rays, rounds, seconds, tally.error, faults);
  }
}

TEST_P(Attack, FindsNoWrongAnswer) {
  const auto start = std::chrono::steady_clock::now();
  const auto elapsed = [&start] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  const double seconds = seconds_asked();
  const bool is_long = seconds > 0;
  const std::vector<SurfaceSpec> surfaces = attacked_surfaces(GetParam());
  Totals totals;
  std::size_t round = 0;
  for (; is_long ? elapsed() < seconds : round == 0; ++round) {
    for (std::size_t turn = 0; turn < surfaces.size() && (!is_long || elapsed() < seconds); ++turn) {
      Rng rng(hash_combine(hash_combine(seed(), std::uint64_t{round}), std::uint64_t{turn}));
      const SurfaceSpec spec = surface_of(GetParam(), round, turn, surfaces[turn], rng);
      Target target(spec, fmt::format("seed {} round {} surface {}", seed(), round, turn), totals);
      attack(target, round, is_long ? kLong : kShort, rng);
    }
  }
  print(GetParam(), totals, round, elapsed());
  EXPECT_EQ(totals.wrong, 0U);
}

/// Asks the rays of a file of tests/data; returns how many.
std::size_t replay(const char* file) {
  std::ifstream in(std::string(GRAZE_TEST_DATA) + "/" + file);
  std::map<std::string, Totals> totals;
  std::size_t lines = 0;
  for (std::string text; std::getline(in, text); ++lines) {
    const nlohmann::json line = nlohmann::json::parse(text);
    Ray ray;
    for (std::size_t i = 0; i < kNumbers; ++i)
      number(ray, i) = parse_hex_float(line[i < 3 ? "o" : "d"][i % 3].get<std::string>()).value();
    const SurfaceSpec spec = parse_surface(line["surface"].get<std::string>());
    Target target(spec, "found before", totals[spec.type]);
    EXPECT_EQ(target.ask(ray).hits, line["truth"].size()) << line["origin"];
  }
  for (const auto& [type, total] : totals) {
    print(type, total, 1, 0);
    EXPECT_EQ(total.wrong, 0U) << type;
  }
  return lines;
}

TEST(Adversary, FindsTheMendedRaysRight) { EXPECT_GE(replay("surfaces_hard.jsonl"), 100U); }

TEST(Adversary, FindsTheOpenRaysNoWorseThanKnown) { replay("surfaces_open.jsonl"); }

std::vector<std::string_view> types() {
  std::vector<std::string_view> names;
  for (const SurfaceEntry& entry : surface_registry()) names.push_back(entry.name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(On, Attack, testing::ValuesIn(types()),
                         [](const auto& type) { return std::string(type.param); });

}  // namespace
}  // namespace graze::test
