#include <graze/surfaces/plane.hpp>

#include <algorithm>

namespace graze {
// --------------------------------------------------------------------------------------------------- exact

PlaneExact::PlaneExact(const Plane& surface) : data(surface.data) {}

FormulationInfo PlaneExact::info() {
  return {"exact",
          "(a.p - b) + (a.d) delta = 0, recentred at the crossing; exact signs of a.d and a.o - b",
          "graze (surfaces/plane.md)",
          {Form::polynomial, Form::scalar, Form::interval},
          1};
}

void PlaneExact::pose(const LocalRay& ray, EquationBlock& block) const {
  const bool usable = planar::is_usable(ray);
  if (!usable && !planar::is_for_integers(ray, data.plane, block)) return block.settle(Status::failed);
  planar::Judge judge(usable && data.plane.holds(ray), data.plane.exact);
  const planar::Meeting meeting = planar::meet(judge, data.plane, ray);
  const bool from_behind =
      data.one_sided && meeting == planar::Meeting::ahead &&
      judge.sign([&](auto number) { return data.plane.slope<decltype(number)>(ray); }) > 0;
  if (judge.undecided()) return block.settle(Status::uncertain);
  if (meeting == planar::Meeting::within && !data.one_sided) return block.settle(Status::coincident);
  if (meeting != planar::Meeting::ahead || from_behind) return;
  planar::pose_crossing(block, ray, ray.seed(), data.plane, judge);
}

void PlaneExact::lift(const LocalRay& /*ray*/, const Posed& posed, const Root& root,
                      std::vector<LocalHit>& hits) const {
  planar::lift_exact(posed, root, hits);
}

// --------------------------------------------------------------------------------------------------- plain

PlanePlain::PlanePlain(const Plane& surface) : data(surface.data) {}

FormulationInfo PlanePlain::info() {
  return {"plain",
          "t = (b - a.o) / (a.d)",
          "documents 001 and 002, with the sign corrected",
          {Form::polynomial, Form::scalar, Form::interval},
          1,
          true};
}

void PlanePlain::pose(const LocalRay& ray, EquationBlock& block) const {
  if (data.one_sided && !(data.plane.slope<double>(ray) < 0)) return;
  planar::pose_plain(block, ray, ray.seed(), [&](auto number) {
    using T = decltype(number);
    return std::array<T, 2>{data.plane.height(planar::exactly<T>(ray.o)), data.plane.slope<T>(ray)};
  });
}

void PlanePlain::lift(const LocalRay& ray, const Posed& posed, const Root& root,
                      std::vector<LocalHit>& hits) const {
  planar::lift_plain(ray, posed, root, hits, [](auto) { return true; });
}

// --------------------------------------------------------------------------------------------------- plane

SurfaceInfo Plane::info() {
  SurfaceInfo info;
  info.summary = "the plane a.x = b, one- or two-sided";
  info.source = "documents 001 and 002";
  info.page = "surfaces/plane.md";
  info.parameters = {"a", "b", "one_sided"};
  return info;
}

Parameters Plane::scaled(const Parameters& parameters, double factor) {
  constexpr std::array kLengths{Length{"b"}};
  return scale_lengths(parameters, kLengths, factor);
}

Plane::Plane(const SurfaceSpec& spec) {
  const Vec3 a = vec3(spec.parameters, "a");
  const double b = spec.parameters.number("b");
  if (a == Vec3{}) throw std::invalid_argument("parameter 'a' must not be zero: it is the plane's normal");
  data.one_sided = spec.parameters.flag("one_sided", false);
  through_origin_ = b == 0;
  normal_ = normalized(a);

  // a in [1, 2), b in [1, 2) by powers of two, as far as double reaches.
  constexpr int kLargestUnit = 1000;
  const int a_exponent = exponent_of(max_abs(a));
  if (b != 0) unit_ = std::clamp(exponent_of(b) - a_exponent, -kLargestUnit, kLargestUnit);
  data.plane.n = {planar::scaled_number(a.x, -a_exponent, data.plane.exact),
                  planar::scaled_number(a.y, -a_exponent, data.plane.exact),
                  planar::scaled_number(a.z, -a_exponent, data.plane.exact)};
  data.plane.b = planar::scaled_number(b, -a_exponent - unit_, data.plane.exact);
  data.plane.note_bits();
  const double distance = mid(data.plane.b.near) / norm(scale_by_power(a, -a_exponent));
  foot_ = scale_by_power(distance * normal_, unit_);
  if (b != 0) size_ = scale_by_power(std::fabs(distance), unit_);
}

namespace {

/// |x|, or infinity in place of zero, which has no bits to lose.
double least_size(double x) { return x == 0 ? std::numeric_limits<double>::infinity() : std::fabs(x); }

}  // namespace

/// A plane through the origin has no length of its own: the ray's origin is the unit, so that scaling the
/// scene changes no bit here either.
void Plane::measure_by_itself(LocalRay& ray) {
  const double size = max_abs(ray.o);
  if (size == 0 || !std::isfinite(size)) return;
  const auto measure = [&ray](int k) {
    ray.o = ray.p = scale_by_power(ray.o, -k);
    ray.l_exponent += k;
    ray.unit += k;
  };
  // Where that loses bits, or could lose those of a hit, numbers start higher up.
  constexpr int kHigh = 900;
  const int k = exponent_of(size);
  const double least = std::min({least_size(ray.o.x), least_size(ray.o.y), least_size(ray.o.z)});
  measure(exponent_of(least) - k < -kHigh ? k - kHigh : k);
}

bool Plane::clip(LocalRay& ray) const {
  if (through_origin_) measure_by_itself(ray);
  return clip_about_crossing(ray);
}

/// Where l, or the slope, is near the ends of double in the plane's units, l is measured in others; false: it
/// is not.
bool Plane::keep_in_range(LocalRay& ray, const Interval& l) {
  constexpr int kMost = 1000;  // exponents that leave room for the bounds of l, and for d
  const bool is_high = !(mag(l) < 0x1p1000);
  const bool is_low = mag(l) < 0x1p-1000 && ray.l_exponent > 0;
  const bool is_new = exponent_of(max_abs(ray.d)) == 0;
  if (!is_new || (!is_high && !is_low)) return false;
  measure_l(ray, is_high ? kMost : std::max(-ray.l_exponent, -kMost));
  return true;
}

/// Recentres at the crossing, so that delta is a correction of the last digits: a plane has no middle, and a
/// grazing ray may meet it anywhere.
bool Plane::clip_about_crossing(LocalRay& ray) const {
  ray.lo = 0;
  ray.hi = std::numeric_limits<double>::infinity();
  if (!planar::is_usable(ray)) {
    planar::measure_far(ray);
    return true;
  }
  const planar::Judge judge(data.plane.holds(ray));
  constexpr double kCoarse = 0x1p-20;
  const Interval c1 =
      judge.enclosure([&](auto number) { return data.plane.slope<decltype(number)>(ray); }, kCoarse);
  const Interval c0 = judge.enclosure(
      [&](auto number) { return data.plane.height(origin_as<decltype(number)>(ray)); }, kCoarse);
  const Interval l = -c0 / c1;
  if (l.hi < 0 && !contains_zero(c1)) return false;
  if (keep_in_range(ray, l)) return clip_about_crossing(ray);
  constexpr double kNear = 4;  // sizes: from there on a hit has digits to lose
  const double middle = mid(l);
  if (!(l.lo > 0 && middle > kNear && width(l) <= 0x1p-10 * middle)) return true;
  set_centre(ray, middle);
  ray.lo = -middle;
  if (planar::is_usable(ray)) return true;
  ray.centre = ray.lo = 0;
  ray.p = ray.o;
  return true;
}

SurfaceSample Plane::sample(double u, double v) const {
  const auto [first, second] = planar::tangents(normal_);
  return {foot_ + (size_ * (2 * u - 1)) * first + (size_ * (2 * v - 1)) * second, normal_};
}

Landmarks Plane::landmarks() const {
  const auto [first, second] = planar::tangents(normal_);
  const auto reach = [&](double a, double b) { return size_ * (std::fabs(a) + std::fabs(b)); };
  Landmarks marks;
  marks.centre = foot_;
  marks.half = {reach(first.x, second.x), reach(first.y, second.y), reach(first.z, second.z)};
  marks.parallels = {first, second};
  marks.has_axis = normal_.x == 0 && normal_.z == 0;
  if (marks.has_axis) marks.poles = {foot_};
  return marks;
}

}  // namespace graze
