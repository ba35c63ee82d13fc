#include "deploy/sim/room/room.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace fleetloc {
namespace {

const Eigen::Vector3d kRoomHalfSize{5.0, 4.0, 2.0};
constexpr double kSkin = 1e-3;  // surfaces closer than this touch [m]

Pose placed(const Eigen::Vector3d& center, double yaw, double roll = 0.0) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
                             Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX())),
          center};
}

bool contains(const Room::Box& box, double margin_m, const Eigen::Vector3d& p_room) {
  const Eigen::Array3d p_box = (inverse(box.T_room_box) * p_room).array().abs();
  return (p_box < box.half_size.array() + margin_m).all();
}

// The slabs of an axis-aligned box against the segment, in the frame of the box.
bool crosses(const Room::Box& box,
             const Eigen::Vector3d& from_room,
             const Eigen::Vector3d& to_room) {
  const Pose T_box_room = inverse(box.T_room_box);
  const Eigen::Vector3d start = T_box_room * from_room;
  const Eigen::Vector3d direction = T_box_room * to_room - start;
  double enter = 0.0;
  double leave = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double half = box.half_size[axis] - kSkin;
    if (std::abs(direction[axis]) < 1e-12) {
      if (std::abs(start[axis]) > half) {
        return false;
      }
      continue;
    }
    const double a = (-half - start[axis]) / direction[axis];
    const double b = (half - start[axis]) / direction[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter < leave;
}

}  // namespace

Room::Room() {
  furniture_ = {
      {placed({0.2, -0.1, 0.38}, 0.35), {0.8, 0.5, 0.38}},     // table
      {placed({-4.6, 1.8, 1.05}, 0.0), {0.35, 0.9, 1.05}},     // cupboard
      {placed({4.55, -2.2, 0.9}, 0.0), {0.4, 0.7, 0.9}},       // cupboard
      {placed({4.3, 3.4, 1.6}, 0.6), {0.3, 0.3, 1.6}},         // pillar, turned
      {placed({-4.2, -3.2, 0.6}, -0.5), {0.6, 0.4, 0.6}},      // chest, turned
      {placed({0.8, 3.65, 0.55}, 0.0), {1.3, 0.3, 0.55}},      // sideboard
      {placed({-1.6, -3.75, 1.3}, 0.0), {0.8, 0.2, 1.3}},      // shelf
      {placed({2.2, -3.6, 0.7}, 0.25), {0.5, 0.3, 0.7}},       // crate, turned
      {placed({-2.0, 3.6, 2.9}, 0.0, 0.7), {1.2, 0.5, 0.05}},  // panel, tilted
      {placed({0.0, 0.0, 3.8}, 0.2), {2.0, 0.15, 0.2}},        // beam under the ceiling
  };
  for (std::size_t i = 0; i < furniture_.size(); ++i) {
    add_faces(furniture_[i], i);
  }
  add_faces({placed({0.0, 0.0, kRoomHalfSize.z()}, 0.0), kRoomHalfSize}, furniture_.size());
}

void Room::add_faces(const Box& box, std::size_t index) {
  const Eigen::Matrix3d R = box.T_room_box.R.toRotationMatrix();
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3;
    const int v = (axis + 2) % 3;
    for (const double side : {-1.0, 1.0}) {
      surfaces_.push_back({box.T_room_box.p + side * box.half_size[axis] * R.col(axis),
                           box.half_size[u] * R.col(u),
                           box.half_size[v] * R.col(v),
                           index});
    }
  }
}

// Not inside of furniture, behind a wall, or between a box and the wall that it stands against.
bool Room::is_visible(const Eigen::Vector3d& p_room, std::size_t own_box) const {
  const bool is_wall = own_box == furniture_.size();
  const Box room{placed({0.0, 0.0, kRoomHalfSize.z()}, 0.0), kRoomHalfSize};
  if (!is_wall && !contains(room, -kSkin, p_room)) {
    return false;
  }
  for (std::size_t i = 0; i < furniture_.size(); ++i) {
    if (i != own_box && contains(furniture_[i], kSkin, p_room)) {
      return false;
    }
  }
  return true;
}

bool Room::is_in_sight(const Eigen::Vector3d& from_room, const Eigen::Vector3d& to_room) const {
  return std::none_of(furniture_.begin(), furniture_.end(), [&](const Box& box) {
    return crosses(box, from_room, to_room);
  });
}

std::vector<Eigen::Vector3d> Room::random_surface_points(int count,
                                                         const CounterRandom& random) const {
  std::vector<double> area_until;  // cumulative
  double area = 0.0;
  for (const Rectangle& surface : surfaces_) {
    area += 4.0 * surface.half_u.norm() * surface.half_v.norm();
    area_until.push_back(area);
  }
  std::vector<Eigen::Vector3d> points;
  points.reserve(static_cast<std::size_t>(std::max(count, 0)));
  for (std::uint64_t trial = 0; points.size() < static_cast<std::size_t>(std::max(count, 0));
       ++trial) {
    const auto chosen =
        std::upper_bound(area_until.begin(), area_until.end(), area * random.uniform(trial, 0));
    const Rectangle& surface = surfaces_[static_cast<std::size_t>(chosen - area_until.begin())];
    const Eigen::Vector3d p = surface.center +
                              (2.0 * random.uniform(trial, 1) - 1.0) * surface.half_u +
                              (2.0 * random.uniform(trial, 2) - 1.0) * surface.half_v;
    if (is_visible(p, surface.box)) {
      points.push_back(p);
    }
  }
  return points;
}

std::vector<Eigen::Vector3d> Room::surface_grid(double spacing_m) const {
  std::vector<Eigen::Vector3d> points;
  for (const Rectangle& surface : surfaces_) {
    const int columns = std::max(1, static_cast<int>(2.0 * surface.half_u.norm() / spacing_m));
    const int rows = std::max(1, static_cast<int>(2.0 * surface.half_v.norm() / spacing_m));
    for (int i = 0; i < columns; ++i) {
      for (int j = 0; j < rows; ++j) {
        const Eigen::Vector3d p = surface.center +
                                  ((2.0 * i + 1.0) / columns - 1.0) * surface.half_u +
                                  ((2.0 * j + 1.0) / rows - 1.0) * surface.half_v;
        if (is_visible(p, surface.box)) {
          points.push_back(p);
        }
      }
    }
  }
  return points;
}

const std::vector<Room::Box>& Room::furniture() const {
  return furniture_;
}

}  // namespace fleetloc
