#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace fleetloc {

/// A path over the ground, sampled at equal horizontal steps.
struct RoutePath {
  double step_m = 0.0;                    ///< between points, up to rounding
  std::vector<Eigen::Vector3d> points_m;  ///< at least two
  std::vector<double> curvature_per_m;    ///< of each point, seen from above, not negative

  [[nodiscard]] double length_m() const;
  /// Linear interpolation at a horizontal distance from the start; beyond the ends: the ends.
  [[nodiscard]] Eigen::Vector3d at(double distance_m) const;
  [[nodiscard]] double curvature_at(double distance_m) const;
};

/// The polyline with its corners rounded to arcs of at most `corner_radius_m` (less where legs are
/// short), then smoothed over a quarter of that radius, so that its curvature is continuous.
/// Throws std::invalid_argument for fewer than two waypoints or two equal ones in a row.
RoutePath rounded_path(std::span<const Eigen::Vector3d> waypoints, double corner_radius_m);

}  // namespace fleetloc
