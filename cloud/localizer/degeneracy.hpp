#pragma once

#include <vector>

#include <Eigen/Core>

#include "cloud/localizer/map_match.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/geometry/pose.hpp"

namespace fleetloc {

/// A rigid motion of the whole window, in map axes: x_map becomes center + Exp(theta) (x_map -
/// center) + t. Its coordinates are [lever * theta, t], all in metres.
struct WindowMotion {
  Eigen::Vector3d center_map = Eigen::Vector3d::Zero();
  double lever_m = 1.0;

  /// J with: the right perturbation of T_map_body = J * coordinates, to first order.
  [[nodiscard]] Matrix6d by_body(const Pose& T_map_body) const;
};

struct DegeneracyConfig {
  double weak_sigma_m;      ///< a direction that the map holds less well than this is weak
  double normal_sigma_rad;  ///< noise of the map's normals, which feigns information
};

/// What the map alone says about one rigid motion of the window.
struct MapConstraint {
  WindowMotion motion;
  Vector6d sigmas_m = Vector6d::Constant(1e6);          ///< along the eigen-directions, worst first
  Eigen::Matrix<double, 6, Eigen::Dynamic> weak{6, 0};  ///< orthonormal, in coordinates of motion
};

/// The landmarks are eliminated: each match weighs by map noise plus the landmark's own covariance
/// along the normal. Point-to-point matches count along the normal only, since along the surface
/// the nearest point of a map follows the landmark. Rotation is scaled by the median distance of
/// the matched landmarks from their mean.
MapConstraint analyze_map_constraint(const std::vector<MapMatch>& matches,
                                     const DegeneracyConfig& config);

DegeneracyConfig read_degeneracy_config(ConfigReader section);

}  // namespace fleetloc
