#pragma once

#include <cstddef>

#include <Eigen/Core>

#include "shared/core/ids.hpp"

namespace fleetloc {

/// A landmark of the window, as the association takes it.
struct WindowLandmark {
  LandmarkId id{};
  Eigen::Vector3d p_map = Eigen::Vector3d::Zero();  ///< [m]
  /// Position of the camera in its newest observation [m].
  Eigen::Vector3d viewpoint_map = Eigen::Vector3d::Zero();
  /// Of its position, given the poses of the keyframes that observe it; mostly along the line of
  /// sight [m^2].
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

/// A landmark matched with a point of the map; one match at most for each landmark.
struct MapMatch {
  WindowLandmark landmark;
  std::size_t map_point = 0;
  Eigen::Vector3d q_map = Eigen::Vector3d::Zero();   ///< [m]
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< unit; zero if the map does not know it
  bool is_planar = false;                            ///< point to plane, else point to point
  bool is_level = false;                             ///< planar and level: constrains height only
  double sigma_m = 0.0;   ///< of map and association, and of the share in the map cell's budget
  double widening = 1.0;  ///< of sigma_m while the gate is still wide
};

}  // namespace fleetloc
