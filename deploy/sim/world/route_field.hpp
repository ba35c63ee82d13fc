#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

namespace fleetloc {

/// A rectangle on the ground, in map.
struct Footprint {
  Eigen::Vector2f center = Eigen::Vector2f::Zero();
  Eigen::Vector2f half_size = Eigen::Vector2f::Zero();  ///< along its heading and across [m]
  float yaw_rad = 0.0F;

  [[nodiscard]] float distance(const Eigen::Vector2f& p) const;  ///< 0 inside [m]
  [[nodiscard]] bool overlaps(const Footprint& other) const;
};

/// The route of the body over the ground, as points 0.5 m apart, with spatial queries.
class RouteField {
 public:
  /// @param route_map  positions of the body along the route, at least two that differ
  /// Throws std::invalid_argument otherwise, or for a number that is not finite.
  explicit RouteField(std::span<const Eigen::Vector3d> route_map);

  [[nodiscard]] float length_m() const;
  [[nodiscard]] Eigen::Vector3f position(float arc_m) const;  ///< arc_m is clamped to the route
  [[nodiscard]] float heading_rad(float arc_m) const;
  /// `lateral_m` to the left of the route, which is extended straight beyond its ends; z is that of
  /// the route [m].
  [[nodiscard]] Eigen::Vector3f beside(float arc_m, float lateral_m) const;

  /// Horizontal distance to the nearest point of the whole route, at most `max_m` [m].
  [[nodiscard]] float distance(const Eigen::Vector2f& p, float max_m) const;
  [[nodiscard]] bool is_clear(const Footprint& footprint, float clearance_m) const;

  /// Points of the route within the horizontal `radius_m`.
  [[nodiscard]] std::vector<Eigen::Vector3f> near(const Eigen::Vector2f& p, float radius_m) const;

  [[nodiscard]] const std::vector<Eigen::Vector3f>& points() const { return points_; }

 private:
  template <typename Visit>
  void visit_near(const Eigen::Vector2f& p, float radius_m, const Visit& visit) const;

  std::vector<Eigen::Vector3f> points_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;  ///< indices of points_
};

}  // namespace fleetloc
