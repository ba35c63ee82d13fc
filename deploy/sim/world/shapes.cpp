#include "deploy/sim/world/shapes.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>

#include <Eigen/Geometry>

namespace fleetloc {
namespace {

void add_triangle(Mesh& mesh, const std::array<std::uint32_t, 3>& corners, std::uint32_t surface) {
  mesh.triangles.push_back(corners);
  mesh.surfaces.push_back(surface);
}

}  // namespace

std::uint32_t add_surface(SceneObject& object, Pattern pattern, float albedo, std::uint32_t seed) {
  object.surfaces.push_back(make_surface(pattern, albedo, seed, object.placement));
  return static_cast<std::uint32_t>(object.surfaces.size() - 1);
}

void add_quad(SceneObject& object,
              const std::array<Eigen::Vector3f, 4>& corners,
              std::uint32_t surface) {
  const auto first = static_cast<std::uint32_t>(object.mesh.vertices.size());
  for (const auto& corner : corners) {
    object.mesh.vertices.push_back(object.placement.to_map(corner));
  }
  add_triangle(object.mesh, {first, first + 1, first + 2}, surface);
  add_triangle(object.mesh, {first, first + 2, first + 3}, surface);
}

void add_box(SceneObject& object,
             const Eigen::Vector3f& center,
             const Eigen::Vector3f& size,
             std::uint32_t surface) {
  const auto first = static_cast<std::uint32_t>(object.mesh.vertices.size());
  for (std::uint32_t i = 0; i < 8; ++i) {
    const Eigen::Vector3f sign((i & 1U) != 0U ? 0.5F : -0.5F,
                               (i & 2U) != 0U ? 0.5F : -0.5F,
                               (i & 4U) != 0U ? 0.5F : -0.5F);
    object.mesh.vertices.push_back(object.placement.to_map(center + sign.cwiseProduct(size)));
  }
  constexpr std::array<std::array<std::uint32_t, 4>, 6> kFaces = {
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  for (const auto& f : kFaces) {
    add_triangle(object.mesh, {first + f[0], first + f[1], first + f[2]}, surface);
    add_triangle(object.mesh, {first + f[0], first + f[2], first + f[3]}, surface);
  }
}

void add_rod(SceneObject& object, const Rod& rod, std::uint32_t surface) {
  const Eigen::Vector3f axis = (rod.to - rod.from).normalized();
  const Eigen::Vector3f u = axis.unitOrthogonal();
  const Eigen::Vector3f v = axis.cross(u);
  const auto first = static_cast<std::uint32_t>(object.mesh.vertices.size());
  const auto sides = static_cast<std::uint32_t>(rod.sides);
  for (std::uint32_t i = 0; i < sides; ++i) {
    const float angle =
        2.0F * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(sides);
    const Eigen::Vector3f around = std::cos(angle) * u + std::sin(angle) * v;
    object.mesh.vertices.push_back(object.placement.to_map(rod.from + rod.radii_m[0] * around));
    object.mesh.vertices.push_back(object.placement.to_map(rod.to + rod.radii_m[1] * around));
  }
  const auto corner = [&](std::uint32_t i, std::uint32_t end) {
    return first + 2 * (i % sides) + end;
  };
  for (std::uint32_t i = 0; i < sides; ++i) {
    add_triangle(object.mesh, {corner(i, 0), corner(i + 1, 0), corner(i + 1, 1)}, surface);
    add_triangle(object.mesh, {corner(i, 0), corner(i + 1, 1), corner(i, 1)}, surface);
  }
  for (std::uint32_t i = 1; i + 1 < sides; ++i) {
    add_triangle(object.mesh, {corner(0, 1), corner(i, 1), corner(i + 1, 1)}, surface);
  }
}

void append(const SceneObject& object, Mesh& mesh, std::vector<Surface>& surfaces) {
  const auto first_vertex = static_cast<std::uint32_t>(mesh.vertices.size());
  const auto first_surface = static_cast<std::uint32_t>(surfaces.size());
  const Mesh& own = object.mesh;
  mesh.vertices.insert(mesh.vertices.end(), own.vertices.begin(), own.vertices.end());
  for (std::size_t i = 0; i < own.triangles.size(); ++i) {
    const auto& t = own.triangles[i];
    add_triangle(mesh,
                 {t[0] + first_vertex, t[1] + first_vertex, t[2] + first_vertex},
                 own.surfaces[i] + first_surface);
  }
  surfaces.insert(surfaces.end(), object.surfaces.begin(), object.surfaces.end());
}

}  // namespace fleetloc
