#pragma once

#include <optional>
#include <string_view>

#include "shared/core/time.hpp"
#include "shared/geometry/pose.hpp"

namespace fleetloc {

/// Quality of a pose; what it means for driving: PoseFusion.
enum class Quality {
  kInitializing,   ///< no pose yet
  kLocalized,      ///< by its covariance the map pose is within 0.25 m and 2 degrees
  kDeadReckoning,  ///< it is less certain, or no answer has confirmed it for long
  kLost,           ///< the map pose must not be used: answers contradict it, or it has aged
  kSearching,      ///< there is no map pose yet: the first answer is awaited
};

/// Name in files, e.g. "dead_reckoning".
std::string_view name(Quality quality);

/// The robot's output, at IMU rate.
struct PoseEstimate {
  Timestamp stamp;
  Quality quality = Quality::kInitializing;
  Duration since_last_answer{};  ///< since the stamp of the newest answer that was applied
  Pose T_odom_body;
  Matrix6d covariance_odom = Matrix6d::Zero();       ///< right perturbation of T_odom_body
  std::optional<Pose> T_map_body;                    ///< from the first applied answer on
  Matrix6d covariance_map = Matrix6d::Zero();        ///< right perturbation of T_map_body
  Eigen::Vector3d v_odom = Eigen::Vector3d::Zero();  ///< of body [m/s]
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< of body, in body [rad/s]
};

}  // namespace fleetloc
