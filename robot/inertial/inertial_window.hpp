#pragma once

#include <vector>

#include "robot/inertial/preintegration.hpp"
#include "shared/model/inertial.hpp"

namespace fleetloc {

/// Consecutive states joined by preintegrated measurements, and what is known of the velocity and
/// the biases of the oldest one. The part of a sliding window that a submap's virtual odometry is
/// made of.
struct InertialWindow {
  std::vector<NavState> states;         ///< oldest first, n
  std::vector<Preintegration> between;  ///< n - 1
  /// Covariance of [velocity, gyroscope bias, accelerometer bias] of the oldest state: its marginal
  /// in the odometry, without terms that came from the cloud.
  Matrix9d oldest_covariance = Matrix9d::Identity();
  /// Mean of that marginal, seen from the oldest state: what came from the cloud may have moved it.
  Vector9d oldest_mean = Vector9d::Zero();
};

}  // namespace fleetloc
