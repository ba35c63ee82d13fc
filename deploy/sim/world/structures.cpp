#include <cmath>
#include <cstddef>
#include <numbers>

#include "deploy/sim/world/furniture.hpp"

namespace fleetloc {
namespace {

void add_container(SceneObject& object, Draw& draw) {
  const std::uint32_t paint =
      add_surface(object, Pattern::kPanels, draw.uniform(0.2F, 0.6F), draw.bits());
  const std::uint32_t trim =
      add_surface(object, Pattern::kTrim, draw.uniform(0.1F, 0.4F), draw.bits());
  const std::uint32_t poster = add_surface(object, Pattern::kPoster, 0.5F, draw.bits());
  add_box(object, {0, 0, 1.2F}, {6.1F, 2.4F, 2.8F}, paint);
  for (int i = 0; i < 13; ++i) {
    const float x = 0.48F * static_cast<float>(i - 6);
    add_box(object, {x, 0, 1.3F}, {0.09F, 2.52F, 2.3F}, trim);
  }
  for (const float y : {-1.28F, 1.28F}) {
    add_box(object, {draw.uniform(-1.8F, 1.8F), y, 1.4F}, {1.6F, 0.03F, 1.1F}, poster);
  }
}

void add_scaffold(SceneObject& object, Draw& draw) {
  const std::uint32_t metal = add_surface(object, Pattern::kTrim, 0.5F, draw.bits());
  const std::uint32_t planks = add_surface(object, Pattern::kPanels, 0.45F, draw.bits());
  const std::uint32_t net =
      add_surface(object, Pattern::kTarp, draw.uniform(0.3F, 0.6F), draw.bits());
  const float height = draw.uniform(4.0F, 6.5F);
  for (const float y : {-0.7F, 0.7F}) {
    for (int i = 0; i < 4; ++i) {
      const float x = 2.2F * (static_cast<float>(i) - 1.5F);
      add_rod(object,
              {.from = {x, y, -0.5F},
               .to = {x, y, height + 0.6F},
               .radii_m = {0.04F, 0.04F},
               .sides = 5},
              metal);
    }
  }
  for (int storey = 1; 2.0F * static_cast<float>(storey) < height; ++storey) {
    const float z = 2.0F * static_cast<float>(storey);
    add_box(object, {0, 0, z}, {6.8F, 1.3F, 0.06F}, planks);
    for (const float y : {-0.72F, 0.72F}) {
      add_box(object, {0, y, z + 1.0F}, {6.8F, 0.05F, 0.08F}, metal);
    }
  }
  for (int i = 0; i < 3; ++i) {
    const float x = 2.2F * static_cast<float>(i - 1);
    if (!draw.chance(0.85F)) continue;
    const float low = draw.uniform(0.1F, 0.8F);
    for (const float y : {-0.78F, 0.78F}) {
      add_quad(object,
               {{{x - 1.08F, y, low},
                 {x + 1.08F, y, low},
                 {x + 1.08F, y, height},
                 {x - 1.08F, y, height}}},
               net);
    }
  }
}

void add_stall(SceneObject& object, Draw& draw) {
  const std::uint32_t wood =
      add_surface(object, Pattern::kPanels, draw.uniform(0.3F, 0.5F), draw.bits());
  const std::uint32_t cloth =
      add_surface(object, Pattern::kTarp, draw.uniform(0.3F, 0.7F), draw.bits());
  const std::uint32_t goods = add_surface(object, Pattern::kPoster, 0.5F, draw.bits());
  for (const float x : {-2.6F, 2.6F}) {
    for (const float y : {-1.0F, 1.0F}) add_box(object, {x, y, 1.0F}, {0.1F, 0.1F, 3.0F}, wood);
    add_box(object, {x, 0, 1.1F}, {0.05F, 2.0F, 2.2F}, cloth);
  }
  add_box(object, {0, 0, 0.4F}, {5.2F, 1.7F, 1.2F}, wood);
  for (const float side : {-1.0F, 1.0F}) {
    add_quad(object,
             {{{-3.0F, side * 1.25F, 2.2F},
               {3.0F, side * 1.25F, 2.2F},
               {3.0F, 0, 2.9F},
               {-3.0F, 0, 2.9F}}},
             cloth);
    add_quad(object,
             {{{-3.0F, side * 1.25F, 1.9F},
               {3.0F, side * 1.25F, 1.9F},
               {3.0F, side * 1.25F, 2.2F},
               {-3.0F, side * 1.25F, 2.2F}}},
             goods);
  }
  for (int i = 0; i < 8; ++i) {
    const float height = draw.uniform(0.2F, 0.6F);
    add_box(
        object,
        {0.6F * (static_cast<float>(i) - 3.5F), draw.uniform(-0.4F, 0.4F), 1.0F + 0.5F * height},
        {0.45F, 0.6F, height},
        goods);
  }
}

void add_boards(SceneObject& object, Draw& draw) {
  const std::uint32_t posts = add_surface(object, Pattern::kTrim, 0.4F, draw.bits());
  const std::uint32_t poster =
      add_surface(object, Pattern::kPoster, draw.uniform(0.35F, 0.55F), draw.bits());
  const std::uint32_t boards =
      add_surface(object, Pattern::kPanels, draw.uniform(0.3F, 0.6F), draw.bits());
  for (int i = 0; i < 6; ++i) {
    const float x = 1.18F * (static_cast<float>(i) - 2.5F);
    const float height = draw.uniform(2.4F, 3.2F);
    const float shift = draw.uniform(-0.25F, 0.25F);
    add_box(object,
            {x, shift, 0.5F * height - 0.2F},
            {1.14F, 0.06F, height + 0.4F},
            draw.chance(0.6F) ? poster : boards);
    add_box(object, {x - 0.55F, shift, 1.1F}, {0.1F, 0.2F, 3.4F}, posts);
  }
}

/// A heap with a rough surface, highest in the middle.
void add_heap(SceneObject& object, Draw& draw) {
  const std::uint32_t surface = add_surface(object, Pattern::kGravel, 0.4F, draw.bits());
  const std::uint32_t seed = draw.bits();
  const float height = draw.uniform(1.8F, 2.8F);
  constexpr int kColumns = 18;
  constexpr int kRows = 8;
  const auto point = [&](int i, int k) {
    const float x = 2.0F * static_cast<float>(i) / kColumns - 1.0F;
    const float y = 2.0F * static_cast<float>(k) / kRows - 1.0F;
    const float bump = 0.55F + 0.9F * smooth_noise(4.0F * x + 20.0F, 2.5F * y + 20.0F, seed);
    const float z = height * std::sqrt(std::max(0.0F, (1.0F - x * x) * (1.0F - y * y))) * bump;
    return Eigen::Vector3f(3.5F * x, 1.28F * y, z - 0.15F);
  };
  for (int i = 0; i < kColumns; ++i) {
    for (int k = 0; k < kRows; ++k) {
      add_quad(
          object, {point(i, k), point(i + 1, k), point(i + 1, k + 1), point(i, k + 1)}, surface);
    }
  }
}

}  // namespace

SceneObject make_structure(const Placement& placement, int kind, Draw& draw) {
  constexpr std::array<void (*)(SceneObject&, Draw&), kStructureKinds> kMakers = {
      add_container, add_scaffold, add_stall, add_boards, add_heap};
  SceneObject object;
  object.placement = placement;
  kMakers.at(static_cast<std::size_t>(kind))(object, draw);
  return object;
}

}  // namespace fleetloc
