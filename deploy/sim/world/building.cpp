#include "deploy/sim/world/building.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace fleetloc {
namespace {

constexpr float kStorey_m = 3.3F;
constexpr float kHalfPi = 0.5F * std::numbers::pi_v<float>;

/// One wall: x along it, y out of it, z up from the base; the middle of the wall is the origin.
struct Wall {
  SceneObject* object;
  Eigen::Vector3f middle;  // in the object's frame
  Eigen::Vector3f along;
  Eigen::Vector3f out;
  float width_m;

  [[nodiscard]] Eigen::Vector3f at(float x, float y, float z) const {
    return middle + x * along + y * out + z * Eigen::Vector3f::UnitZ();
  }
  [[nodiscard]] Eigen::Vector3f size(float x, float y, float z) const {
    return (x * along + y * out).cwiseAbs() + z * Eigen::Vector3f::UnitZ();
  }
  /// A block on the wall, `depth_m` thick.
  void block(const Eigen::Vector2f& center,
             const Eigen::Vector2f& extent,
             float depth_m,
             std::uint32_t surface) const {
    add_box(*object,
            at(center.x(), 0.5F * depth_m, center.y()),
            size(extent.x(), depth_m, extent.y()),
            surface);
  }
  /// A pane in front of the wall.
  void pane(const Eigen::Vector2f& center,
            const Eigen::Vector2f& extent,
            float depth_m,
            std::uint32_t surface) const {
    const float x = 0.5F * extent.x();
    const float z = 0.5F * extent.y();
    add_quad(*object,
             {at(center.x() - x, depth_m, center.y() - z),
              at(center.x() + x, depth_m, center.y() - z),
              at(center.x() + x, depth_m, center.y() + z),
              at(center.x() - x, depth_m, center.y() + z)},
             surface);
  }
};

struct Look {
  std::uint32_t trim;
  std::uint32_t glass;
  std::uint32_t door;
  float window_width_m;
  float window_height_m;
  float window_spacing_m;
  int bars;  // upright ones in a window
};

void add_window(const Wall& wall, const Eigen::Vector2f& center, const Look& look) {
  const Eigen::Vector2f opening(look.window_width_m, look.window_height_m);
  wall.block(center, opening + Eigen::Vector2f(0.24F, 0.24F), 0.07F, look.trim);
  wall.pane(center, opening, 0.08F, look.glass);
  for (int i = 0; i < look.bars; ++i) {
    const float share = static_cast<float>(i + 1) / static_cast<float>(look.bars + 1) - 0.5F;
    wall.pane(
        {center.x() + share * opening.x(), center.y()}, {0.06F, opening.y()}, 0.10F, look.trim);
  }
  wall.pane({center.x(), center.y() + 0.2F * opening.y()}, {opening.x(), 0.06F}, 0.10F, look.trim);
  wall.block({center.x(), center.y() - 0.5F * opening.y() - 0.14F},
             {opening.x() + 0.4F, 0.10F},
             0.18F,
             look.trim);
}

void add_facade(const Wall& wall, float height_m, const Look& look, Draw& draw) {
  const int storeys = std::max(1, static_cast<int>(height_m / kStorey_m));
  const int columns = static_cast<int>((wall.width_m - 1.0F) / look.window_spacing_m);
  const int door = columns > 0 ? draw.integer(columns) : -1;
  for (int storey = 0; storey < storeys; ++storey) {
    for (int column = 0; column < columns; ++column) {
      const float x = (static_cast<float>(column) - 0.5F * static_cast<float>(columns - 1)) *
                      look.window_spacing_m;
      if (storey == 0 && column == door) {
        wall.block({x, 1.15F}, {1.5F, 2.3F}, 0.08F, look.trim);
        wall.pane({x, 1.05F}, {1.1F, 2.1F}, 0.10F, look.door);
        wall.block({x, 2.6F}, {2.2F, 0.15F}, 0.9F, look.trim);
      } else if (!draw.chance(0.08F)) {
        add_window(wall, {x, kStorey_m * static_cast<float>(storey) + 1.75F}, look);
      }
    }
    wall.block({0.0F, kStorey_m * static_cast<float>(storey + 1)},
               {wall.width_m, 0.22F},
               0.12F,
               look.trim);
  }
  wall.block({0.0F, 0.25F}, {wall.width_m, 0.5F}, 0.06F, look.trim);
  for (const float side : {-1.0F, 1.0F}) {  // drain pipes
    wall.block({side * (0.5F * wall.width_m - 0.4F), 0.5F * height_m},
               {0.12F, height_m},
               0.14F,
               look.trim);
  }
}

void add_flat_roof(SceneObject& object,
                   const Eigen::Vector3f& size,
                   std::uint32_t roof,
                   std::uint32_t trim) {
  add_box(object, {0.0F, 0.0F, size.z() + 0.1F}, {size.x() - 0.1F, size.y() - 0.1F, 0.2F}, roof);
  for (const float side : {-0.5F, 0.5F}) {
    add_box(object, {0.0F, side * size.y(), size.z() + 0.2F}, {size.x() + 0.5F, 0.4F, 0.5F}, trim);
    add_box(object, {side * size.x(), 0.0F, size.z() + 0.2F}, {0.4F, size.y() + 0.5F, 0.5F}, trim);
  }
}

void add_gable_roof(SceneObject& object,
                    const Eigen::Vector3f& size,
                    std::uint32_t roof,
                    std::uint32_t wall) {
  const float x = 0.5F * size.x() + 0.4F;
  const float y = 0.5F * size.y() + 0.5F;
  const float ridge = size.z() + 0.35F * size.y();
  const float eaves = size.z() - 0.1F;
  for (const float side : {-1.0F, 1.0F}) {
    add_quad(object,
             {{{-x, side * y, eaves}, {x, side * y, eaves}, {x, 0.0F, ridge}, {-x, 0.0F, ridge}}},
             roof);
    const float end = side * 0.5F * size.x();
    add_quad(object,
             {{{end, -0.5F * size.y(), size.z()},
               {end, 0.5F * size.y(), size.z()},
               {end, 0.0F, ridge},
               {end, 0.0F, ridge}}},
             wall);
  }
}

Look drawn_look(SceneObject& object, Draw& draw) {
  Look look{};
  look.trim = add_surface(object, Pattern::kTrim, draw.uniform(0.30F, 0.75F), draw.bits());
  look.glass = add_surface(object, Pattern::kGlass, draw.uniform(0.08F, 0.20F), draw.bits());
  look.door = add_surface(object, Pattern::kPaint, draw.uniform(0.12F, 0.5F), draw.bits());
  look.window_width_m = draw.uniform(0.9F, 1.9F);
  look.window_height_m = draw.uniform(1.3F, 1.9F);
  look.window_spacing_m = look.window_width_m + draw.uniform(0.9F, 2.4F);
  look.bars = 1 + draw.integer(3);
  return look;
}

}  // namespace

SceneObject make_building(const BuildingShape& shape, Draw& draw) {
  constexpr std::array<Pattern, 3> kWalls = {Pattern::kPlaster, Pattern::kBrick, Pattern::kPanels};
  SceneObject object;
  object.placement = shape.placement;
  const Look look = drawn_look(object, draw);
  const Pattern pattern = kWalls.at(static_cast<std::size_t>(draw.integer(3)));
  const float tone = draw.uniform(0.32F, 0.70F);
  const std::uint32_t roof =
      add_surface(object, Pattern::kRoof, draw.uniform(0.2F, 0.4F), draw.bits());
  const Eigen::Vector3f& size = shape.size_m;
  std::uint32_t surface = 0;
  for (int side = 0; side < 4; ++side) {
    const float angle = kHalfPi * static_cast<float>(side);
    const Eigen::Vector3f along(std::round(std::cos(angle)), std::round(std::sin(angle)), 0.0F);
    const Eigen::Vector3f out(along.y(), -along.x(), 0.0F);
    const Wall wall{.object = &object,
                    .middle = 0.5F * out.cwiseProduct(size),
                    .along = along,
                    .out = out,
                    .width_m = std::abs(along.dot(size))};
    surface = add_surface(object, pattern, tone * draw.uniform(0.9F, 1.1F), draw.bits());
    const float half = 0.5F * wall.width_m;
    add_quad(object,
             {wall.at(-half, 0.0F, -shape.foundation_m),
              wall.at(half, 0.0F, -shape.foundation_m),
              wall.at(half, 0.0F, size.z()),
              wall.at(-half, 0.0F, size.z())},
             surface);
    add_facade(wall, size.z(), look, draw);
  }
  if (size.z() < 10.0F && draw.chance(0.6F)) {
    add_gable_roof(object, size, roof, surface);
  } else {
    add_flat_roof(object, size, roof, look.trim);
  }
  return object;
}

}  // namespace fleetloc
