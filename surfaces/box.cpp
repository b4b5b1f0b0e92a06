#include <graze/surfaces/box.hpp>

#include <string>

namespace graze {
namespace {

/// Corner i has the upper end in x, y, z where bits 0, 1, 2 of i are set.
convex::Shape shape_of(Vec3 lo, Vec3 hi) {
  convex::Shape shape;
  for (unsigned i = 0; i < 8; ++i) {
    shape.vertices.push_back(
        {(i & 1U) != 0 ? hi.x : lo.x, (i & 2U) != 0 ? hi.y : lo.y, (i & 4U) != 0 ? hi.z : lo.z});
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t own = std::size_t{1} << axis;
    const std::size_t a = std::size_t{1} << (axis + 1) % 3;
    const std::size_t b = std::size_t{1} << (axis + 2) % 3;
    for (const std::size_t start : {std::size_t{0}, a, b, a + b}) shape.edges.push_back({start, start + own});
    for (std::uint32_t side = 0; side < 2; ++side) {
      const std::uint32_t face = 2 * static_cast<std::uint32_t>(axis) + side;
      const std::size_t base = side * own;
      shape.triangles.push_back({face, {base, base + a, base + b}});
      shape.triangles.push_back({face, {base + a + b, base + a, base + b}});
      const double sign = side == 0 ? -1 : 1;
      shape.normals.push_back({axis == 0 ? sign : 0.0, axis == 1 ? sign : 0.0, axis == 2 ? sign : 0.0});
    }
  }
  return shape;
}

void check_extent(double lo, double hi, const std::string& axis) {
  if (lo == hi) throw std::invalid_argument("min must be below max in " + axis + ": the box is flat");
  if (lo > hi) throw std::invalid_argument("min must be below max in " + axis + ": the box is reversed");
}

convex::Grain grain_of(const std::array<BoxFace, 6>& faces) {
  convex::Grain grain{Bits(1.0), {}};
  for (const BoxFace& face : faces) grain.offset = grain.offset | Bits(face.at);
  return grain;
}

}  // namespace

SurfaceInfo Box::info() {
  SurfaceInfo info;
  info.summary = "the boundary of a solid with sides parallel to the axes";
  info.source = "document 001";
  info.page = "surfaces/box.md";
  info.parameters = {"min", "max"};
  info.params = {"face", ""};
  return info;
}

Parameters Box::scaled(const Parameters& parameters, double factor) {
  constexpr std::array kLengths{Length{"min"}, Length{"max"}};
  return scale_lengths(parameters, kLengths, factor);
}

Box::Box(const SurfaceSpec& spec) {
  const Vec3 lo = vec3(spec.parameters, "min");
  const Vec3 hi = vec3(spec.parameters, "max");
  check_extent(lo.x, hi.x, "x");
  check_extent(lo.y, hi.y, "y");
  check_extent(lo.z, hi.z, "z");
  shape = shape_of(lo, hi);
  measure();
  const Vec3 low = scale_by_power(lo, -unit());
  const Vec3 high = scale_by_power(hi, -unit());
  faces = {BoxFace{0, -1, low.x}, BoxFace{0, 1, high.x}, BoxFace{1, -1, low.y},
           BoxFace{1, 1, high.y}, BoxFace{2, -1, low.z}, BoxFace{2, 1, high.z}};
  grain = grain_of(faces);
}

template struct convex::Exact<Box>;
template struct convex::Plain<Box>;

static_assert(SurfaceType<Box>);

}  // namespace graze
