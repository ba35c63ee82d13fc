#include "deploy/sim/world/furniture.hpp"

#include <cmath>
#include <numbers>

namespace fleetloc {

SceneObject make_pole(const Placement& placement, Draw& draw) {
  SceneObject pole;
  pole.placement = placement;
  const std::uint32_t metal =
      add_surface(pole, Pattern::kTrim, draw.uniform(0.15F, 0.5F), draw.bits());
  const std::uint32_t notice = add_surface(pole, Pattern::kPoster, 0.5F, draw.bits());
  const float height = draw.uniform(3.8F, 6.5F);
  add_rod(pole,
          {.from = {0, 0, -0.5F}, .to = {0, 0, height}, .radii_m = {0.09F, 0.05F}, .sides = 8},
          metal);
  add_rod(pole,
          {.from = {0, 0, 0.4F}, .to = {0, 0, 0.9F}, .radii_m = {0.14F, 0.12F}, .sides = 8},
          metal);
  add_rod(pole,
          {.from = {0, 0, height - 0.1F},
           .to = {0.9F, 0, height + 0.2F},
           .radii_m = {0.04F, 0.04F},
           .sides = 5},
          metal);
  add_box(pole, {1.0F, 0, height + 0.2F}, {0.6F, 0.25F, 0.14F}, metal);
  if (draw.chance(0.5F)) add_box(pole, {0, 0, 1.6F}, {0.42F, 0.24F, 0.6F}, notice);
  return pole;
}

SceneObject make_sign(const Placement& placement, Draw& draw) {
  SceneObject sign;
  sign.placement = placement;
  const std::uint32_t metal = add_surface(sign, Pattern::kTrim, 0.4F, draw.bits());
  const std::uint32_t board =
      add_surface(sign, Pattern::kPoster, draw.uniform(0.4F, 0.6F), draw.bits());
  const float width = draw.uniform(0.6F, 1.6F);
  const float height = draw.uniform(0.6F, 1.2F);
  const float top = draw.uniform(1.9F, 2.8F);
  for (const float side : {-0.4F, 0.4F}) {
    add_rod(sign,
            {.from = {0.02F, side * width, -0.5F},
             .to = {0.02F, side * width, top},
             .radii_m = {0.035F, 0.035F},
             .sides = 6},
            metal);
  }
  add_box(sign, {0, 0, top - 0.5F * height}, {0.04F, width, height}, board);  // across the route
  return sign;
}

SceneObject make_wall(const Placement& placement, const Eigen::Vector3f& size_m, Draw& draw) {
  SceneObject wall;
  wall.placement = placement;
  const Pattern pattern = draw.chance(0.5F) ? Pattern::kBrick : Pattern::kSlabs;
  const std::uint32_t stone = add_surface(wall, pattern, draw.uniform(0.3F, 0.5F), draw.bits());
  const std::uint32_t cap =
      add_surface(wall, Pattern::kTrim, draw.uniform(0.4F, 0.7F), draw.bits());
  const float below_ground = 1.0F;
  add_box(wall,
          {0, 0, 0.5F * (size_m.z() - below_ground)},
          {size_m.x(), size_m.y(), size_m.z() + below_ground},
          stone);
  add_box(wall, {0, 0, size_m.z() + 0.04F}, {size_m.x() + 0.1F, size_m.y() + 0.14F, 0.09F}, cap);
  return wall;
}

SceneObject make_bench_or_boxes(const Placement& placement, Draw& draw) {
  SceneObject object;
  object.placement = placement;
  const std::uint32_t wood =
      add_surface(object, Pattern::kPanels, draw.uniform(0.25F, 0.5F), draw.bits());
  const std::uint32_t paint =
      add_surface(object, Pattern::kPoster, draw.uniform(0.3F, 0.55F), draw.bits());
  if (draw.chance(0.5F)) {
    add_box(object, {0, 0, 0.45F}, {1.7F, 0.45F, 0.07F}, wood);
    add_box(object, {0, 0.22F, 0.75F}, {1.7F, 0.06F, 0.4F}, wood);
    for (const float x : {-0.7F, 0.7F}) add_box(object, {x, 0, 0.1F}, {0.1F, 0.4F, 0.7F}, paint);
    return object;
  }
  for (int i = 0; i < 3; ++i) {
    const float x = 0.6F * static_cast<float>(i - 1);
    const float height = draw.uniform(0.4F, 1.2F);
    add_box(object,
            {x, draw.uniform(-0.1F, 0.1F), 0.5F * height - 0.2F},
            {0.5F, 0.5F, height + 0.4F},
            i == 1 ? wood : paint);
  }
  return object;
}

SceneObject make_car(const Placement& placement, Draw& draw) {
  SceneObject car;
  car.placement = placement;
  const std::uint32_t paint =
      add_surface(car, Pattern::kPaint, draw.uniform(0.08F, 0.7F), draw.bits());
  const std::uint32_t glass = add_surface(car, Pattern::kGlass, 0.1F, draw.bits());
  const std::uint32_t dark = add_surface(car, Pattern::kTrim, 0.07F, draw.bits());
  const std::uint32_t plate = add_surface(car, Pattern::kPoster, 0.6F, draw.bits());
  const float length = draw.uniform(3.8F, 4.5F);
  const float width = draw.uniform(1.65F, 1.85F);
  const float roof = draw.uniform(1.4F, 1.75F);
  add_box(car, {0, 0, 0.62F}, {length, width, 0.6F}, paint);
  add_box(car, {0, 0, 0.42F}, {length + 0.08F, width + 0.03F, 0.14F}, dark);
  // The cabin narrows upwards: glass below, the roof above, posts at its corners.
  const float base = 0.92F;
  const float y0 = 0.47F * width;
  const float y1 = 0.38F * width;
  const std::array<Eigen::Vector3f, 4> low = {{{-0.42F * length, -y0, base},
                                               {0.24F * length, -y0, base},
                                               {0.24F * length, y0, base},
                                               {-0.42F * length, y0, base}}};
  const std::array<Eigen::Vector3f, 4> high = {{{-0.34F * length, -y1, roof},
                                                {0.08F * length, -y1, roof},
                                                {0.08F * length, y1, roof},
                                                {-0.34F * length, y1, roof}}};
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t k = (i + 1) % 4;
    add_quad(car, {low[i], low[k], high[k], high[i]}, glass);
    add_rod(car, {.from = low[i], .to = high[i], .radii_m = {0.06F, 0.06F}, .sides = 4}, paint);
  }
  add_box(car, {-0.13F * length, 0, roof}, {0.44F * length, 2.0F * y1 + 0.06F, 0.07F}, paint);
  for (const float y : {-0.5F, 0.5F}) {
    add_box(car, {-0.06F * length, y * width * 0.94F, 1.15F}, {0.07F, 0.12F, 0.5F}, paint);
    for (const float x : {-0.31F, 0.31F}) {
      const Eigen::Vector3f hub(x * length, y * width, 0.31F);
      add_rod(car,
              {.from = hub - Eigen::Vector3f(0, 0.12F, 0),
               .to = hub + Eigen::Vector3f(0, 0.03F, 0),
               .radii_m = {0.31F, 0.31F},
               .sides = 12},
              dark);
    }
  }
  for (const float x : {-0.51F, 0.51F}) {
    add_box(car, {x * length, 0, 0.6F}, {0.04F, 0.5F, 0.13F}, plate);
    for (const float y : {-0.36F, 0.36F}) {
      add_box(car, {x * length, y * width, 0.72F}, {0.03F, 0.3F, 0.16F}, plate);
    }
  }
  return car;
}

}  // namespace fleetloc
