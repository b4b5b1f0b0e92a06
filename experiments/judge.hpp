// Judges a solver's answer for one ray against truth.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <graze/experiments/truth.hpp>
#include <graze/surfaces/hit.hpp>

namespace graze {

/// A ray's answer: what the judge reads from a HitBuffer.
struct Claim {
  Status status = Status::ok;
  std::span<const double> l;
  std::span<const Vec3> point;
  std::span<const Vec3> normal;
  std::span<const std::uint32_t> multiplicity = {};  ///< empty: 1 each
};

enum class Verdict { right, wrong, uncertain, failed };
std::string_view to_string(Verdict verdict);

/// How to judge.
struct Measure {
  /// A claimed l answers a true l* if |l - l*| <= match_radius (|l*| + L/|d|): far beyond any rounding, far
  /// below what a picture shows.
  double match_radius = 1e-6;
  double size = 1;  ///< L
};

/// Errors of one answer. A missed hit is an infinite error and stays in the denominator; nothing to measure
/// (no true hit) is none.
struct Judgement {
  Verdict verdict = Verdict::right;
  int missed = 0;    ///< true hits that are not reported
  int spurious = 0;  ///< reported hits that are not true
  bool wrong_first = false;
  std::optional<double> ulps;             ///< worst |l - l*| / ulp(l*)
  std::optional<double> condition_units;  ///< worst |l - l*| / (eps (|l*| + L/|n.d|)), eps = 2^-52
  std::optional<double>
      backward;  ///< worst distance of a claimed point from the surface, in ulps of the inputs
  std::optional<double> normal_error;  ///< worst angle to the true normal, radians
};

/// A hit of multiplicity m that is claimed at the double nearest to several true hits, or next to it, answers
/// up to m of them: doubles cannot part them (two faces of a solid beside its edge).
/// Wrong: a spurious hit, or a missed one under status ok, or a coincidence not seen or invented. An
/// uncertain or failed answer may miss, but what it lists must be true. `surface` measures the claimed
/// points' distances; null leaves `backward` out.
Judgement judge(const Ray& ray, const truth::Answer& truth, const Claim& claim, const Measure& measure,
                const truth::Surface* surface);

/// Whether truth's verdict (status, number of hits) changes when one of the six numbers of the ray moves by
/// one ulp: twelve more truths.
bool is_ambiguous(const truth::Surface& surface, const Ray& ray, const truth::Answer& truth);

/// Largest relative condition (|l*| + L/|n.d|) / |l*| of the hits; none without hits.
std::optional<double> condition(const truth::Answer& truth, const Ray& ray, double size);

}  // namespace graze
