#include <graze/surfaces/tetrahedron.hpp>

#include <string>
#include <utility>

namespace graze {
namespace {

std::vector<Vec3> read_vertices(const Parameters& parameters) {
  const std::vector<std::vector<double>> rows = parameters.table("vertices", 3);
  if (rows.size() != 4) {
    throw std::invalid_argument("vertices must hold 4 points, not " + std::to_string(rows.size()));
  }
  std::vector<Vec3> vertices;
  for (const auto& row : rows) vertices.push_back({row[0], row[1], row[2]});
  return vertices;
}

/// n.(apex - a): negative where the apex lies behind the face, as it must.
int side_of(const TetrahedronFace& face, Vec3 apex) {
  return exact_sign([&](auto number) {
    using T = decltype(number);
    const auto [x, y, z] = face.cross_as<T>();
    return x * (exactly<T>(apex.x) - exactly<T>(face.a.x)) + y * (exactly<T>(apex.y) - exactly<T>(face.a.y)) +
           z * (exactly<T>(apex.z) - exactly<T>(face.a.z));
  });
}

constexpr double kOneUlp = 0x1p-52;

/// The face opposite to vertex i, facing away from it.
TetrahedronFace face_opposite(const std::array<Vec3, 4>& v, std::size_t i, const Bits& bits) {
  TetrahedronFace face;
  face.a = v[(i + 1) % 4];
  face.b = v[(i + 2) % 4];
  face.c = v[(i + 3) % 4];
  const int side = side_of(face, v[i]);
  if (side == 0) throw std::invalid_argument("vertices lie in one plane: the tetrahedron is flat");
  if (side > 0) std::swap(face.b, face.c);
  for (std::size_t k = 0; k < 3; ++k) {
    const auto part = [&](auto number) { return face.cross_as<decltype(number)>()[k]; };
    face.normal[k] = sharp_enclosure(part, bits.is_exact(), kOneUlp);
  }
  const auto [x, y, z] = face.cross_as<double>();
  face.rounded = {x, y, z};
  return face;
}

}  // namespace

SurfaceInfo Tetrahedron::info() {
  SurfaceInfo info;
  info.summary = "the boundary of the solid between four points";
  info.source = "document 004";
  info.page = "surfaces/tetrahedron.md";
  info.parameters = {"vertices"};
  info.params = {"face", ""};
  return info;
}

Parameters Tetrahedron::scaled(const Parameters& parameters, double factor) {
  constexpr std::array kLengths{Length{"vertices"}};
  return scale_lengths(parameters, kLengths, factor);
}

Tetrahedron::Tetrahedron(const SurfaceSpec& spec) {
  shape.vertices = read_vertices(spec.parameters);
  measure();
  std::array<Vec3, 4> local;
  Bits length;
  for (std::size_t i = 0; i < 4; ++i) {
    local[i] = scale_by_power(shape.vertices[i], -unit());
    length = length | Bits(local[i]);
  }
  grain = {length * length, length * length * length};
  for (std::uint32_t i = 0; i < 4; ++i) {
    faces[i] = face_opposite(local, i, grain.normal);
    const auto& [x, y, z] = faces[i].normal;
    shape.normals.push_back(normalized({mid(x), mid(y), mid(z)}));
    shape.triangles.push_back({i, {(i + 1) % 4U, (i + 2) % 4U, (i + 3) % 4U}});
    for (std::size_t k = i + 1; k < 4; ++k) shape.edges.push_back({i, k});
  }
}

template struct convex::Exact<Tetrahedron>;
template struct convex::Plain<Tetrahedron>;

static_assert(SurfaceType<Tetrahedron>);

}  // namespace graze
