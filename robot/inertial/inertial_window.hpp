#pragma once

#include <vector>

#include "robot/inertial/preintegration.hpp"
#include "shared/model/inertial.hpp"

namespace fleetloc {

/// Consecutive states joined by preintegrated measurements, and what is known of the velocity and
/// the biases of the oldest one. The part of a sliding window that a submap's virtual odometry is
/// made of.
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
