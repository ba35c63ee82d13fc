#include "deploy/sim/world/dynamic_objects.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include "deploy/sim/world/draw.hpp"

namespace fleetloc {
namespace {

void add_rider(SceneObject& object, float seat_m, Draw& draw) {
  const std::uint32_t coat =
      add_surface(object, Pattern::kCloth, draw.uniform(0.1F, 0.6F), draw.bits());
  const std::uint32_t trousers =
      add_surface(object, Pattern::kCloth, draw.uniform(0.08F, 0.35F), draw.bits());
  const std::uint32_t skin = add_surface(object, Pattern::kCloth, 0.45F, draw.bits());
  const Eigen::Vector3f hip(0, 0, seat_m);
  const Eigen::Vector3f neck = hip + Eigen::Vector3f(0.06F, 0, 0.58F);
  add_rod(object, {.from = hip, .to = neck, .radii_m = {0.17F, 0.21F}, .sides = 8}, coat);
  add_rod(object,
          {.from = neck,
           .to = neck + Eigen::Vector3f(0.02F, 0, 0.28F),
           .radii_m = {0.09F, 0.10F},
           .sides = 8},
          skin);
  for (const float y : {-1.0F, 1.0F}) {
    add_rod(object,
            {.from = hip + Eigen::Vector3f(0, 0.09F * y, 0.05F),
             .to = {0.14F * y, 0.09F * y, 0.0F},
             .radii_m = {0.10F, 0.06F},
             .sides = 6},
            trousers);
    add_rod(object,
            {.from = neck + Eigen::Vector3f(0, 0.22F * y, -0.03F),
             .to = hip + Eigen::Vector3f(0.2F - 0.1F * y, 0.24F * y, 0.0F),
             .radii_m = {0.06F, 0.05F},
             .sides = 6},
            coat);
  }
}

void add_bicycle(SceneObject& object, Draw& draw) {
  const std::uint32_t frame =
      add_surface(object, Pattern::kPaint, draw.uniform(0.1F, 0.7F), draw.bits());
  const std::uint32_t tyre = add_surface(object, Pattern::kTrim, 0.08F, draw.bits());
  constexpr int kPieces = 12;
  for (const float x : {-0.52F, 0.52F}) {
    const auto rim = [&](int i) {
      const float angle = 2.0F * std::numbers::pi_v<float> * static_cast<float>(i) / kPieces;
      return Eigen::Vector3f(x + 0.33F * std::cos(angle), 0.0F, 0.34F + 0.33F * std::sin(angle));
    };
    for (int i = 0; i < kPieces; ++i) {
      add_rod(object,
              {.from = rim(i), .to = rim(i + 1), .radii_m = {0.025F, 0.025F}, .sides = 4},
              tyre);
    }
  }
  const std::array<std::pair<Eigen::Vector3f, Eigen::Vector3f>, 5> tubes = {{
      {{-0.52F, 0, 0.34F}, {-0.1F, 0, 0.3F}},
      {{-0.1F, 0, 0.3F}, {-0.2F, 0, 0.95F}},
      {{-0.1F, 0, 0.3F}, {0.38F, 0, 0.85F}},
      {{-0.2F, 0, 0.85F}, {0.38F, 0, 0.85F}},
      {{0.52F, 0, 0.34F}, {0.36F, 0, 1.05F}},
  }};
  for (const auto& [from, to] : tubes) {
    add_rod(object, {.from = from, .to = to, .radii_m = {0.025F, 0.025F}, .sides = 5}, frame);
  }
  add_box(object, {0.36F, 0, 1.05F}, {0.05F, 0.55F, 0.04F}, frame);
}

struct Habit {
  float min_m_per_s;
  float max_m_per_s;
  float half_length_m;
  bool rides;
};

std::vector<DynamicObject> drawn(const RouteField& route,
                                 float per_100_m,
                                 std::uint64_t seed,
                                 const Habit& habit) {
  const auto count = static_cast<std::uint64_t>(std::lround(per_100_m * route.length_m() / 100.0F));
  std::vector<DynamicObject> dynamic_objects;
  for (std::uint64_t i = 0; i < count; ++i) {
    Draw draw(seed, RandomStream::kDynamicObject, 2 * i + (habit.rides ? 1 : 0));
    DynamicObject dynamic_object;
    dynamic_object.half_length_m = habit.half_length_m * draw.uniform(0.5F, 1.0F);
    dynamic_object.arc_m = draw.uniform(0.0F, route.length_m());
    dynamic_object.speed_m_per_s = draw.uniform(habit.min_m_per_s, habit.max_m_per_s);
    dynamic_object.lateral_m = draw.uniform(1.0F, 2.4F) * (draw.chance(0.5F) ? 1.0F : -1.0F);
    dynamic_object.start_s =
        draw.uniform(0.0F, 4.0F * dynamic_object.half_length_m / dynamic_object.speed_m_per_s);
    if (habit.rides) add_bicycle(dynamic_object.object, draw);
    add_rider(dynamic_object.object, habit.rides ? 0.95F : 0.9F, draw);
    dynamic_objects.push_back(std::move(dynamic_object));
  }
  return dynamic_objects;
}

}  // namespace

Placement DynamicObject::at(const RouteField& route, float body_height_m, double time_s) const {
  const double round_m = 4.0 * static_cast<double>(half_length_m);
  const double gone = static_cast<double>(speed_m_per_s) * (time_s + static_cast<double>(start_s));
  const auto phase_m = static_cast<float>(gone - round_m * std::floor(gone / round_m));
  const bool is_going = phase_m < 2.0F * half_length_m;
  const float arc = arc_m + (is_going ? phase_m - half_length_m : 3.0F * half_length_m - phase_m);
  Placement placement;
  placement.p_map = route.beside(arc, lateral_m);
  placement.p_map.z() -= body_height_m;
  placement.yaw_rad = route.heading_rad(arc) + (is_going ? 0.0F : std::numbers::pi_v<float>);
  return placement;
}

std::vector<DynamicObject> drawn_people(const RouteField& route,
                                        float per_100_m,
                                        std::uint64_t seed) {
  return drawn(route,
               per_100_m,
               seed,
               {.min_m_per_s = 0.8F, .max_m_per_s = 1.7F, .half_length_m = 18.0F, .rides = false});
}

std::vector<DynamicObject> drawn_cyclists(const RouteField& route,
                                          float per_100_m,
                                          std::uint64_t seed) {
  return drawn(route,
               per_100_m,
               seed,
               {.min_m_per_s = 3.0F, .max_m_per_s = 5.0F, .half_length_m = 40.0F, .rides = true});
}

}  // namespace fleetloc
