#include <graze/surfaces/disk.hpp>

#include <numbers>

namespace graze {

// --------------------------------------------------------------------------------------------------- exact

DiskExact::DiskExact(const Disk& surface) : data(surface.data) {}

FormulationInfo DiskExact::info() {
  return {"exact",
          "n.(p - c) + (n.d) delta = 0; inside by the exact sign of |x - c|^2 - r^2",
          "graze (surfaces/disk.md)",
          {Form::polynomial, Form::scalar, Form::interval},
          1};
}

void DiskExact::pose(const LocalRay& ray, EquationBlock& block) const {
  const Bits x = planar::bits_of(ray.o) | planar::bits_of(data.centre) | planar::bits_of(data.radius);
  const Bits side = data.plane.n_bits * x * planar::bits_of(ray.d);
  planar::pose_exact(
      block, ray, data.plane, planar::is_exact(side * side),
      [&](planar::Judge& judge) {
        block.spend(1);
        return is_inside(ray, judge);
      },
      [&](planar::Judge& judge) { pose_within(ray, judge, block); });
}

bool DiskExact::is_inside(const LocalRay& ray, planar::Judge& judge) const {
  return judge.sign([&](auto number) {
    using T = decltype(number);
    const planar::Array3<T> p = planar::point_of_line<T>(ray), d = direction_as<T>(ray);
    const planar::Array3<T> from = planar::difference(p, planar::exactly<T>(data.centre));
    const T c0 = planar::inner(data.plane.normal<T>(), from), c1 = data.plane.slope<T>(ray);
    const planar::Array3<T> x{c1 * from[0] - c0 * d[0], c1 * from[1] - c0 * d[1], c1 * from[2] - c0 * d[2]};
    const T rim = exactly<T>(data.radius) * c1;
    return x[0] * x[0] + x[1] * x[1] + x[2] * x[2] - rim * rim;
  }) <= 0;
}

/// The ray runs in the plane, where a l^2 + 2 b l + c <= 0 with a = d.d, b = d.(o - c), c = |o - c|^2 - r^2.
void DiskExact::pose_within(const LocalRay& ray, planar::Judge& judge, EquationBlock& block) const {
  const auto b = [&](auto number) {
    using T = decltype(number);
    return planar::inner(direction_as<T>(ray),
                         planar::difference(origin_as<T>(ray), planar::exactly<T>(data.centre)));
  };
  const auto c = [&](auto number) {
    using T = decltype(number);
    const planar::Array3<T> from = planar::difference(origin_as<T>(ray), planar::exactly<T>(data.centre));
    const T r = exactly<T>(data.radius);
    return planar::inner(from, from) - r * r;
  };
  // The discriminant b^2 - a c does not depend on the point of the line: p is the best one.
  const int discriminant = judge.sign([&](auto number) {
    using T = decltype(number);
    const planar::Array3<T> d = direction_as<T>(ray);
    const planar::Array3<T> from =
        planar::difference(planar::point_of_line<T>(ray), planar::exactly<T>(data.centre));
    const T r = exactly<T>(data.radius), along = planar::inner(d, from);
    return along * along - planar::inner(d, d) * (planar::inner(from, from) - r * r);
  });
  const bool approaches = judge.sign(b) < 0;
  const bool starts_inside = judge.sign(c) < 0;
  if (judge.undecided() || discriminant < 0) return;
  if (discriminant > 0) {
    if (approaches || starts_inside) block.settle(Status::coincident);
  } else if (approaches) {
    planar::pose_touch(block, ray, data.centre, 0, judge);
  }
}

void DiskExact::lift(const LocalRay& /*ray*/, const Posed& posed, const Root& root,
                     std::vector<LocalHit>& hits) const {
  planar::lift_exact(posed, root, hits);
}

// --------------------------------------------------------------------------------------------------- plain

DiskPlain::DiskPlain(const Disk& surface) : data(surface.data) {}

FormulationInfo DiskPlain::info() {
  return {"plain",
          "t = n.(c - o) / (n.d), then |o + t d - c| <= r",
          "document 002",
          {Form::polynomial, Form::scalar, Form::interval},
          1,
          true};
}

void DiskPlain::pose(const LocalRay& ray, EquationBlock& block) const {
  planar::pose_plain(block, ray, ray.seed(), [&](auto number) {
    using T = decltype(number);
    const planar::Array3<T> from =
        planar::difference(planar::exactly<T>(ray.o), planar::exactly<T>(data.centre));
    return std::array<T, 2>{planar::inner(data.plane.normal<T>(), from), data.plane.slope<T>(ray)};
  });
}

void DiskPlain::lift(const LocalRay& ray, const Posed& posed, const Root& root,
                     std::vector<LocalHit>& hits) const {
  planar::lift_plain(ray, posed, root, hits, [&](auto number) {
    using T = decltype(number);
    const planar::Array3<T> from =
        planar::difference(planar::plain_point<T>(ray, root.x), planar::exactly<T>(data.centre));
    return std::sqrt(planar::inner(from, from)) <= exactly<T>(data.radius);
  });
}

// ---------------------------------------------------------------------------------------------------- disk

SurfaceInfo Disk::info() {
  SurfaceInfo info;
  info.summary = "the disk |x - c| <= r in the plane through c with normal n";
  info.source = "document 002";
  info.page = "surfaces/disk.md";
  info.parameters = {"center", "normal", "radius"};
  return info;
}

Parameters Disk::scaled(const Parameters& parameters, double factor) {
  constexpr std::array kLengths{Length{"center"}, Length{"radius"}};
  return scale_lengths(parameters, kLengths, factor);
}

Disk::Disk(const SurfaceSpec& spec)
    : centre_(vec3(spec.parameters, "center", {})), radius_(spec.parameters.number("radius")) {
  const Vec3 n = vec3(spec.parameters, "normal");
  if (n == Vec3{}) throw std::invalid_argument("parameter 'normal' must not be zero");
  if (radius_ <= 0) throw std::invalid_argument("parameter 'radius' must be positive");
  normal_ = normalized(n);
  unit_ = exponent_of(radius_);
  data.centre = scale_by_power(centre_, -unit_);
  data.radius = scale_by_power(radius_, -unit_);

  const int exponent = exponent_of(max_abs(n));
  planar::ExactPlane& plane = data.plane;
  plane.n = {planar::scaled_number(n.x, -exponent, plane.exact),
             planar::scaled_number(n.y, -exponent, plane.exact),
             planar::scaled_number(n.z, -exponent, plane.exact)};
  plane.note_bits();
  plane.exact =
      plane.exact && is_finite(data.centre) && planar::is_exact(plane.n_bits * planar::bits_of(data.centre));
  if (plane.exact) {
    plane.b = planar::ExactNumber(
        planar::inner(plane.normal<Expansion>(), planar::exactly<Expansion>(data.centre)));
  } else {
    plane.b.near = planar::inner(plane.normal<Interval>(), planar::exactly<Interval>(data.centre));
  }
  plane.note_bits();
}

Vec3 Disk::half() const {
  // r times the distance of n from each axis.
  return {radius_ * std::hypot(normal_.y, normal_.z), radius_ * std::hypot(normal_.x, normal_.z),
          radius_ * std::hypot(normal_.x, normal_.y)};
}

Bounds Disk::bounds() const { return box_about(centre_, half()); }

SurfaceSample Disk::sample(double u, double v) const {
  const auto [first, second] = planar::tangents(normal_);
  const double rho = radius_ * std::sqrt(u), angle = 2 * std::numbers::pi * v;
  return {centre_ + (rho * std::cos(angle)) * first + (rho * std::sin(angle)) * second, normal_};
}

Landmarks Disk::landmarks() const {
  const auto [first, second] = planar::tangents(normal_);
  Landmarks marks;
  marks.centre = centre_;
  marks.half = half();
  marks.parallels = {first, second};
  marks.has_axis = normal_.x == 0 && normal_.z == 0 && centre_.x == 0 && centre_.z == 0;
  if (marks.has_axis) marks.poles = {centre_};
  return marks;
}

}  // namespace graze
