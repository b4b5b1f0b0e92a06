#include <algorithm>
#include <cmath>
#include <graze/experiments/truth_frame.hpp>
#include <stdexcept>

namespace graze::truth {
namespace {

/// n / |n| with each component to 2^-60 at least, less than 1/64 ulp of 1; takes as many bits as that needs.
Intervals unit_normal(const NormalAt& normal, long bits) {
  for (;; bits *= 2) {
    const Intervals n = normal(bits);
    const Interval squared = squared_length(n);
    if (squared.contains_zero()) continue;
    const Interval length = sqrt(squared);
    const Intervals unit{n[0] / length, n[1] / length, n[2] / length};
    if (unit[0].is_absolute(60) && unit[1].is_absolute(60) && unit[2].is_absolute(60)) return unit;
  }
}

Matrix adjugate_of(const Matrix& m) {
  Matrix adjugate;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector& a = m[(i + 1) % 3];
    const Vector& b = m[(i + 2) % 3];
    for (std::size_t j = 0; j < 3; ++j)
      adjugate[j][i] = a[(j + 1) % 3] * b[(j + 2) % 3] - a[(j + 2) % 3] * b[(j + 1) % 3];
  }
  return adjugate;
}

}  // namespace

Integer inner(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Vector apply(const Matrix& m, const Vector& v) { return {inner(m[0], v), inner(m[1], v), inner(m[2], v)}; }

bool is_zero(const Vector& v) { return sign(v[0]) == 0 && sign(v[1]) == 0 && sign(v[2]) == 0; }

void CommonExponent::see(double x) {
  const Dyadic d = exact(x);
  if (d.m != 0 && (!seen_ || d.e < e_)) e_ = d.e;
  seen_ = seen_ || d.m != 0;
}

void CommonExponent::see(Vec3 v) {
  see(v.x);
  see(v.y);
  see(v.z);
}

Integer CommonExponent::operator()(double x) const {
  const Dyadic d = exact(x);
  return d.m == 0 ? Integer(0) : shifted(Integer(d.m), d.e - e_);
}

Transform prepare(const Placement& placement) {
  Transform t;
  t.translate = placement.translate;
  t.identity = placement.matrix == kIdentity;
  CommonExponent common;
  for (const Vec3& row : placement.matrix) {
    if (!is_finite(row)) throw std::invalid_argument("matrix has an entry that is not finite");
    common.see(row);
  }
  if (!is_finite(placement.translate))
    throw std::invalid_argument("translate has an entry that is not finite");
  const Matrix m{common(placement.matrix[0]), common(placement.matrix[1]), common(placement.matrix[2])};
  t.adjugate = adjugate_of(m);
  t.e = common.e();
  t.det = m[0][0] * t.adjugate[0][0] + m[0][1] * t.adjugate[1][0] + m[0][2] * t.adjugate[2][0];
  if (sign(t.det) == 0) throw std::invalid_argument("matrix is singular");
  if (sign(t.det) < 0) {
    t.det = -t.det;
    for (auto& row : t.adjugate)
      for (auto& c : row) c = -c;
  }
  return t;
}

ObjectRay to_object(const Transform& transform, const Ray& ray) {
  CommonExponent origin;
  origin.see(ray.o);
  origin.see(transform.translate);
  CommonExponent direction;
  direction.see(ray.d);
  const Vector o = origin(ray.o);
  const Vector t = origin(transform.translate);
  const Vector from{o[0] - t[0], o[1] - t[1], o[2] - t[2]};
  const Vector d = direction(ray.d);
  if (transform.identity) return {from, d, origin.e(), direction.e()};
  return {apply(transform.adjugate, from), apply(transform.adjugate, d), origin.e(), direction.e()};
}

std::optional<Answer> refusal(const Ray& ray) {
  if (is_valid(ray)) return std::nullopt;
  Answer answer;
  answer.status = Status::invalid;
  answer.why = is_finite(ray.o) && is_finite(ray.d) ? "the ray's direction is zero"
                                                    : "the ray has a coordinate that is not finite";
  return answer;
}

Answer coincident_answer() {
  Answer answer;
  answer.status = Status::coincident;
  answer.why = "the ray runs inside the surface";
  return answer;
}

Number rational_length(const Rational& l) {
  return {[l](long bits) { return Interval::of(l, bits + 2); }, [l](const Rational& q) { return q == l; }};
}

double coordinate(double o, double d, Number& l) {
  if (d == 0) return o;
  const Rational zero = -rational(o) / rational(d);
  bool asked = false;
  for (long bits = 128;; bits *= 2) {
    const Interval x = Interval::of(o, bits) + l.enclosure(bits) * Interval::of(d, bits);
    // 60 bits: the double is then within 1/64 ulp of nearest.
    if (x.is_relative(60)) return x.middle();
    if (!asked && l.equals(zero)) return 0;
    asked = true;
  }
}

Vec3 point_at(const Ray& ray, Number& l) {
  return {coordinate(ray.o.x, ray.d.x, l), coordinate(ray.o.y, ray.d.y, l), coordinate(ray.o.z, ray.d.z, l)};
}

Intervals to_world(const Transform& transform, const Intervals& n, long bits) {
  if (transform.identity) return n;
  const auto row = [&](std::size_t i) {
    const Matrix& m = transform.adjugate;
    return Interval::of(m[0][i], bits) * n[0] + Interval::of(m[1][i], bits) * n[1] +
           Interval::of(m[2][i], bits) * n[2];
  };
  return {row(0), row(1), row(2)};
}

Interval squared_length(const Intervals& v) { return square(v[0]) + square(v[1]) + square(v[2]); }

void set_normal(Hit& hit, Vec3 d, const NormalAt& normal, bool perpendicular, long most_bits) {
  for (long bits = 128;; bits *= 2) {
    const Intervals n = unit_normal(normal, bits);
    hit.normal = {n[0].middle(), n[1].middle(), n[2].middle()};
    if (perpendicular) return;
    const Intervals along{Interval::of(d.x, bits), Interval::of(d.y, bits), Interval::of(d.z, bits)};
    const Interval cosine =
        (n[0] * along[0] + n[1] * along[1] + n[2] * along[2]) / sqrt(squared_length(along));
    if (cosine.is_relative(60)) hit.cosine = std::fabs(cosine.middle());
    if (cosine.is_relative(60) || bits >= most_bits) return;
  }
}

}  // namespace graze::truth
