#pragma once

#include <vector>

#include "robot/inertial/preintegration.hpp"
#include "shared/model/inertial.hpp"

namespace fleetloc {

/// Consecutive states with the preintegrated measurements between them, and a prior on velocity and
/// biases of the oldest one: the input of a submap's virtual odometry.
struct InertialWindow {
  /// Oldest first, n. The oldest is at the mean of its marginal in the odometry, the others are
  /// where the measurements are linearized.
  std::vector<NavState> states;
  std::vector<Preintegration> between;  ///< n - 1
  /// Covariance of [velocity, gyroscope bias, accelerometer bias] of the oldest state: its marginal
  /// in the odometry, without terms that came from the cloud.
  Matrix9d oldest_covariance = Matrix9d::Identity();
};

}  // namespace fleetloc
