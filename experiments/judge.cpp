#include "judge.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <graze/solvers/math/scaling.hpp>

namespace graze {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kEps = std::numeric_limits<double>::epsilon();

double distance(double l, const truth::Real& truth) { return std::fabs((l - truth.head) - truth.tail); }

/// L/|n.d| for unit n and any d; infinite for a tangent.
double lever(const truth::Hit& hit, const Ray& ray, double size) { return size / (hit.cosine * norm(ray.d)); }

void raise(std::optional<double>& worst, double value) { worst = std::max(worst.value_or(0), value); }

double angle_between(Vec3 a, Vec3 b) {
  const double half_chord = 0.5 * norm(a - b);
  return 2 * std::asin(std::min(1.0, half_chord));
}

/// Errors of a claimed hit that answers a true one.
void measure_hit(const Ray& ray, const truth::Hit& hit, const Claim& claim, std::size_t i, double size,
                 Judgement& judgement) {
  const double error = distance(claim.l[i], hit.l);
  raise(judgement.ulps, error / ulp(hit.l.head));
  raise(judgement.condition_units, error / (kEps * (std::fabs(hit.l.head) + lever(hit, ray, size))));
  if (i < claim.normal.size()) raise(judgement.normal_error, angle_between(claim.normal[i], hit.normal));
}

/// Pairs claimed with true hits in order: both are sorted.
void match(const Ray& ray, const truth::Answer& truth, const Claim& claim, const Measure& measure,
           Judgement& judgement) {
  const double slack = measure.size / norm(ray.d);
  std::size_t i = 0;
  std::uint32_t spare = 0;  // further true hits that the last matched claim may answer
  for (std::size_t k = 0; k < truth.hits.size(); ++k) {
    const truth::Hit& hit = truth.hits[k];
    if (spare > 0 && distance(claim.l[i - 1], hit.l) <= ulp(claim.l[i - 1])) {
      --spare;
      continue;
    }
    const double radius = measure.match_radius * (std::fabs(hit.l.head) + slack);
    for (; i < claim.l.size() && claim.l[i] < hit.l.head - radius; ++i) ++judgement.spurious;
    const bool found = i < claim.l.size() && claim.l[i] <= hit.l.head + radius;
    if (k == 0 && (!found || judgement.spurious > 0)) judgement.wrong_first = true;
    if (found) {
      const std::uint32_t multiplicity = i < claim.multiplicity.size() ? claim.multiplicity[i] : 1;
      spare = multiplicity - std::min(multiplicity, hit.multiplicity);
      measure_hit(ray, hit, claim, i++, measure.size, judgement);
    } else {
      ++judgement.missed;
    }
  }
  judgement.spurious += static_cast<int>(claim.l.size() - i);
  if (truth.hits.empty() && !claim.l.empty()) judgement.wrong_first = true;
  if (judgement.missed > 0) {
    judgement.ulps = judgement.condition_units = kInfinity;
    if (!claim.normal.empty()) judgement.normal_error = kInfinity;
  }
}

/// One ulp of the largest number that enters a point of the ray: |o| + |l d|, or the surface's size.
double input_ulp(const Ray& ray, double l, double size) {
  return ulp(std::max({max_abs(ray.o), std::fabs(l) * max_abs(ray.d), size}));
}

Verdict verdict_of(const truth::Answer& truth, const Claim& claim, const Judgement& judgement) {
  const bool truly_inside = truth.status == Status::coincident;
  if (claim.status == Status::coincident || truly_inside) {
    if (claim.status == Status::uncertain) return Verdict::uncertain;
    if (claim.status == Status::failed) return Verdict::failed;
    return truly_inside && claim.status == Status::coincident ? Verdict::right : Verdict::wrong;
  }
  if (judgement.spurious > 0) return Verdict::wrong;
  if (claim.status == Status::uncertain) return Verdict::uncertain;
  if (claim.status != Status::ok) return Verdict::failed;
  return judgement.missed > 0 ? Verdict::wrong : Verdict::right;
}

}  // namespace

std::string_view to_string(Verdict verdict) {
  constexpr std::array<std::string_view, 4> kNames{"right", "wrong", "uncertain", "failed"};
  return kNames[static_cast<std::size_t>(verdict)];
}

Judgement judge(const Ray& ray, const truth::Answer& truth, const Claim& claim, const Measure& measure,
                const truth::Surface* surface) {
  Judgement judgement;
  if (truth.status != Status::coincident) match(ray, truth, claim, measure, judgement);
  judgement.verdict = verdict_of(truth, claim, judgement);
  if (judgement.verdict != Verdict::wrong) judgement.wrong_first = false;
  if (surface == nullptr) return judgement;
  for (std::size_t i = 0; i < claim.point.size(); ++i) {
    raise(judgement.backward, surface->distance(claim.point[i]) / input_ulp(ray, claim.l[i], measure.size));
  }
  return judgement;
}

bool is_ambiguous(const truth::Surface& surface, const Ray& ray, const truth::Answer& truth) {
  const std::array<double Vec3::*, 3> axes{&Vec3::x, &Vec3::y, &Vec3::z};
  for (Vec3 Ray::*part : {&Ray::o, &Ray::d}) {
    for (double Vec3::*axis : axes) {
      for (const double towards : {-kInfinity, kInfinity}) {
        Ray moved = ray;
        (moved.*part).*axis = std::nextafter((ray.*part).*axis, towards);
        if (!is_valid(moved)) continue;
        const truth::Answer other = surface.all(moved, {.digits = 17});
        if (other.status != truth.status || other.hits.size() != truth.hits.size()) return true;
      }
    }
  }
  return false;
}

std::optional<double> condition(const truth::Answer& truth, const Ray& ray, double size) {
  std::optional<double> worst;
  for (const truth::Hit& hit : truth.hits) {
    raise(worst, (std::fabs(hit.l.head) + lever(hit, ray, size)) / std::fabs(hit.l.head));
  }
  return worst;
}

}  // namespace graze
