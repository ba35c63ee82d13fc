#include "deploy/sim/world/plants.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace fleetloc {
namespace {

constexpr float kTwoPi = 2.0F * std::numbers::pi_v<float>;

Eigen::Vector3f drawn_direction(Draw& draw) {
  const float z = draw.uniform(-1.0F, 1.0F);
  const float angle = draw.uniform(0.0F, kTwoPi);
  const float radius = std::sqrt(1.0F - z * z);
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

/// A cluster of leaves: a polygon of no particular direction.
void add_cluster(SceneObject& object, const Eigen::Vector3f& center, float size_m, Draw& draw) {
  const Eigen::Vector3f normal = drawn_direction(draw);
  const Eigen::Vector3f u = 0.5F * size_m * normal.unitOrthogonal();
  const Eigen::Vector3f v = normal.cross(u);
  const auto reach = [&] { return draw.uniform(0.6F, 1.2F); };
  const auto surface =
      static_cast<std::uint32_t>(draw.integer(static_cast<int>(object.surfaces.size())));
  add_quad(object,
           {center + reach() * u, center + reach() * v, center - reach() * u, center - reach() * v},
           surface);
}

void add_leaves(SceneObject& object,
                const Eigen::Vector3f& center,
                const Eigen::Vector3f& radii,
                int clusters,
                Draw& draw) {
  for (const float tone : {0.75F, 1.0F, 1.3F}) {
    add_surface(object, Pattern::kLeaves, 0.3F * tone, draw.bits());
  }
  for (int i = 0; i < clusters; ++i) {
    const float depth = std::cbrt(draw.uniform(0.25F, 1.0F));  // more of them near the outside
    const Eigen::Vector3f at = center + depth * drawn_direction(draw).cwiseProduct(radii);
    add_cluster(object, at, draw.uniform(0.45F, 0.9F), draw);
  }
}

}  // namespace

Tree make_tree(const Placement& placement, Draw& draw) {
  Tree tree;
  tree.wood.placement = placement;
  tree.crown.placement = placement;
  const float height = draw.uniform(4.5F, 9.0F);
  const float trunk = height * draw.uniform(0.35F, 0.45F);
  const float radius = draw.uniform(0.10F, 0.24F);
  const std::uint32_t bark =
      add_surface(tree.wood, Pattern::kBark, draw.uniform(0.18F, 0.34F), draw.bits());
  const Eigen::Vector3f top(0.0F, 0.0F, trunk);
  add_rod(tree.wood,
          {.from = {0.0F, 0.0F, -0.5F},
           .to = top,
           .radii_m = {radius * 1.2F, radius * 0.8F},
           .sides = 8},
          bark);
  const Eigen::Vector3f radii(0.32F * height, 0.32F * height, 0.34F * height);
  const Eigen::Vector3f center(0.0F, 0.0F, height - radii.z());
  const int branches = 8 + draw.integer(5);
  for (int i = 0; i < branches; ++i) {
    Eigen::Vector3f direction = drawn_direction(draw);
    direction.z() = 0.4F + std::abs(direction.z());
    const Eigen::Vector3f from(0.0F, 0.0F, trunk * draw.uniform(0.7F, 1.0F));
    const Eigen::Vector3f to =
        from + 0.85F * direction.normalized().cwiseProduct(radii) * draw.uniform(0.9F, 1.5F);
    add_rod(
        tree.wood, {.from = from, .to = to, .radii_m = {0.45F * radius, 0.02F}, .sides = 4}, bark);
    const Eigen::Vector3f fork = from + 0.5F * (to - from);
    const Eigen::Vector3f twig = fork + 0.5F * drawn_direction(draw).cwiseProduct(radii);
    add_rod(tree.wood,
            {.from = fork, .to = twig, .radii_m = {0.2F * radius, 0.015F}, .sides = 3},
            bark);
  }
  add_leaves(tree.crown, center, radii, static_cast<int>(height * 34.0F), draw);
  return tree;
}

SceneObject make_bush(const Placement& placement, float radius_m, Draw& draw) {
  SceneObject bush;
  bush.placement = placement;
  const Eigen::Vector3f radii(radius_m, radius_m, 0.7F * radius_m);
  add_leaves(bush, {0.0F, 0.0F, 0.5F * radius_m}, radii, static_cast<int>(40.0F * radius_m), draw);
  return bush;
}

}  // namespace fleetloc
