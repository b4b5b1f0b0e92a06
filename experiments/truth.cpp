#include <algorithm>
#include <array>
#include <cmath>
#include <graze/experiments/truth.hpp>
#include <graze/experiments/truth_number.hpp>
#include <graze/experiments/truth_types.hpp>
#include <stdexcept>

namespace graze::truth {
namespace {

struct Type {
  std::string_view name;
  std::unique_ptr<Surface> (*make)(const SurfaceSpec&);
};

// The one list of types that have truth.
constexpr std::array kTypes{
    Type{"teardrop", make_teardrop},
    Type{"bezier_revolution", make_bezier_revolution},
    Type{"plane", make_plane},
    Type{"triangle", make_triangle},
    Type{"polygon", make_polygon},
    Type{"disk", make_disk},
    Type{"box", make_box},
    Type{"tetrahedron", make_tetrahedron},
    Type{"convex_polyhedron", make_convex_polyhedron},
    Type{"sphere", make_sphere},
    Type{"ellipsoid", make_ellipsoid},
    Type{"quadric", make_quadric},
    Type{"torus", make_torus},
    Type{"implicit_polynomial", make_implicit_polynomial},
};

// Numbers of two surfaces that agree to this many digits are called equal.
constexpr int kMostDigits = 2560;

/// One hit of a scene, and how to get more digits of it.
struct Candidate {
  Hit hit;
  const Surface* surface;
  std::size_t index;  ///< among the surface's hits
};

/// a before b: exact order as far as kMostDigits tell, ties by surface index.
bool before(const Candidate& a, const Candidate& b, const Ray& ray, int digits) {
  int order = compare_decimals(a.hit.l, b.hit.l);
  if (a.surface == b.surface) return a.index < b.index;
  for (int more = 4 * digits; order == 0 && more <= kMostDigits; more *= 4) {
    const Answer first = a.surface->all(ray, {more});
    const Answer second = b.surface->all(ray, {more});
    const Real& x = first.hits[a.index].l;
    const Real& y = second.hits[b.index].l;
    order = compare_decimals(x, y);
    // Two exact decimals that overlap are the same number.
    if (x.lo == x.hi && y.lo == y.hi) break;
  }
  return order != 0 ? order < 0 : a.hit.surface < b.hit.surface;
}

/// Sign of root - bound, exactly.
int compare(Root& root, const Rational& bound) {
  if (!root.exact && vanishes_at(root, {Integer(-numerator(bound)), denominator(bound)}) &&
      rational(root.m, root.k) < bound && bound < rational(root.m + 1, root.k))
    return 0;
  // The root is in an open interval, so a bound at its end is decided.
  for (long k = 64;; k *= 2) {
    const Rational lo = rational(root.m, root.k);
    if (root.exact) return lo < bound ? -1 : (lo > bound ? 1 : 0);
    if (bound <= lo) return 1;
    if (bound >= rational(root.m + 1, root.k)) return -1;
    refine(root, k);
  }
}

PolynomialAnswer invalid(std::string why) {
  PolynomialAnswer answer;
  answer.status = Status::invalid;
  answer.why = std::move(why);
  return answer;
}

/// The coefficients as integers over one power of two, which moves no root.
Polynomial to_polynomial(std::span<const double> c) {
  long e = 0;
  bool seen = false;
  for (const double x : c) {
    const Dyadic d = exact(x);
    if (d.m == 0) continue;
    e = seen ? std::min(e, d.e) : d.e;
    seen = true;
  }
  Polynomial p;
  for (const double x : c) {
    const Dyadic d = exact(x);
    p.push_back(d.m == 0 ? Integer(0) : shifted(Integer(d.m), d.e - e));
  }
  trim(p);
  return p;
}

}  // namespace

std::vector<std::string> types() {
  std::vector<std::string> names;
  for (const Type& type : kTypes) names.emplace_back(type.name);
  return names;
}

std::unique_ptr<Surface> make_surface(const SurfaceSpec& spec) {
  for (const Type& type : kTypes)
    if (type.name == spec.type) return type.make(spec);
  throw std::invalid_argument("no truth for surface type '" + spec.type + "'");
}

Answer all_hits(std::span<const std::unique_ptr<Surface>> scene, const Ray& ray, const Options& options) {
  Answer answer;
  std::vector<Candidate> found;
  for (std::size_t i = 0; i < scene.size(); ++i) {
    Answer one = scene[i]->all(ray, options);
    if (one.status == Status::invalid) return one;
    if (one.status == Status::coincident && answer.status == Status::ok) {
      answer.status = one.status;
      answer.why = one.why;
    }
    for (std::size_t j = 0; j < one.hits.size(); ++j) {
      one.hits[j].surface = i;
      found.push_back({std::move(one.hits[j]), scene[i].get(), j});
    }
  }
  const int digits = std::max(options.digits, 17);
  std::stable_sort(found.begin(), found.end(),
                   [&](const Candidate& a, const Candidate& b) { return before(a, b, ray, digits); });
  for (Candidate& candidate : found) answer.hits.push_back(std::move(candidate.hit));
  return answer;
}

PolynomialAnswer real_roots(std::span<const double> c, std::optional<std::pair<double, double>> interval,
                            const Options& options) {
  for (const double x : c)
    if (!std::isfinite(x)) return invalid("a coefficient is not finite");
  if (interval && (!std::isfinite(interval->first) || !std::isfinite(interval->second)))
    return invalid("an end of the interval is not finite");
  if (interval && interval->first > interval->second) return invalid("the interval is empty");
  PolynomialAnswer answer;
  const Polynomial p = to_polynomial(c);
  if (p.empty()) {
    answer.status = Status::coincident;
    answer.why = "the zero polynomial vanishes everywhere";
    return answer;
  }
  for (Root& root : all_real_roots(p)) {
    if (interval && compare(root, rational(interval->first)) < 0) continue;
    if (interval && compare(root, rational(interval->second)) > 0) continue;
    Number x = number_of(root);
    answer.roots.push_back({to_real(x, std::max(options.digits, 17)), root.multiplicity});
  }
  return answer;
}

}  // namespace graze::truth
