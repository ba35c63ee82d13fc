#pragma once

#include <vector>

#include <Eigen/Core>

#include "cloud/localizer/map_match.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/geometry/pose.hpp"

namespace fleetloc {

/// By how much a turn about the center moves points: their median distance from it, 0.1 m at least
/// [m/rad].
double lever(const std::vector<Eigen::Vector3d>& p_map, const Eigen::Vector3d& center_map);

/// A rigid motion of the whole window, in map axes: x_map becomes center + Exp(theta) (x_map -
/// center) + t. Its coordinates are [lever * theta, t], all in metres.
struct WindowMotion {
  Eigen::Vector3d center_map = Eigen::Vector3d::Zero();
  double lever_m = 1.0;

  /// Jacobian of the right perturbation of T_map_body by the coordinates.
  [[nodiscard]] Matrix6d J_body_motion(const Pose& T_map_body) const;

  /// Gradient of direction_map . p_map by the coordinates, for a point of the window.
  [[nodiscard]] Vector6d gradient(const Eigen::Vector3d& direction_map,
                                  const Eigen::Vector3d& p_map) const;
};

struct DegeneracyConfig {
  double weak_sigma_m;        ///< a direction that the map alone constrains less is weak
  double start_weak_sigma_m;  ///< along these a first place says no more than the start pose
  double normal_sigma_rad;    ///< noise of the map's normals, which would count as information
};

/// Directions of a WindowMotion, orthonormal columns in its coordinates.
using WeakDirections = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/// How the map alone constrains a rigid motion of the window.
struct MapConstraint {
  WindowMotion motion;
  Vector6d sigmas_m = Vector6d::Constant(1e6);  ///< along each of the directions, worst first
  Matrix6d directions = Matrix6d::Identity();   ///< orthonormal columns, in those of motion

  /// The directions along which it holds less well than this.
  [[nodiscard]] WeakDirections weaker_than(double sigma_m) const;
};

/// Eigen-analysis of the matches' information about a rigid motion of the window. The landmarks are
/// eliminated: each match is weighted by map noise plus the landmark's own covariance along the
/// normal. Point-to-point matches count along the normal only, since along the surface the nearest
/// point of a map follows the landmark. Rotation is scaled by the median distance of the matched
/// landmarks from their mean.
/// @param normal_sigma_rad  see DegeneracyConfig
MapConstraint analyze_map_constraint(const std::vector<MapMatch>& matches, double normal_sigma_rad);

DegeneracyConfig read_degeneracy_config(ConfigReader section);

}  // namespace fleetloc
