#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "shared/core/counter_random.hpp"
#include "shared/geometry/pose.hpp"

namespace fleetloc {

/// A furnished room of 10 x 8 x 4 m: origin in the middle of the floor, z up. Furniture are boxes,
/// some of them turned or tilted; the path of RoomTrajectory stays clear of them.
class Room {
 public:
  Room();

  /// Whether nothing lies between two points; the surfaces that they lie on do not count.
  [[nodiscard]] bool is_in_sight(const Eigen::Vector3d& from_room,
                                 const Eigen::Vector3d& to_room) const;

  /// `count` points, spread evenly at random over the visible surfaces.
  [[nodiscard]] std::vector<Eigen::Vector3d> random_surface_points(
      int count, const CounterRandom& random) const;

  /// A regular grid on all visible surfaces.
  [[nodiscard]] std::vector<Eigen::Vector3d> surface_grid(double spacing_m) const;

  struct Box {
    Pose T_room_box;
    Eigen::Vector3d half_size;  ///< [m]
  };
  [[nodiscard]] const std::vector<Box>& furniture() const;

 private:
  struct Rectangle {
    Eigen::Vector3d center;
    Eigen::Vector3d half_u;
    Eigen::Vector3d half_v;
    std::size_t box;  ///< that it belongs to; the number of boxes: the room itself
  };
  void add_faces(const Box& box, std::size_t index);
  [[nodiscard]] bool is_visible(const Eigen::Vector3d& p_room, std::size_t own_box) const;

  std::vector<Box> furniture_;
  std::vector<Rectangle> surfaces_;
};

}  // namespace fleetloc
