#pragma once

#include <span>

#include "shared/trajectory/trajectory.hpp"

namespace fleetloc {

enum class Alignment {
  kNone,
  kYaw,  ///< position and yaw, which are unobservable to visual-inertial odometry
  kSe3,
};

/// T_truth_estimate that minimizes the squared distances of positions (Umeyama 1991, without
/// scale). Identity for kNone and without pairs; where the positions leave a rotation free, one of
/// the minimizers.
Pose align(std::span<const PosePair> pairs, Alignment alignment);

/// Aligns position and heading of the first pair exactly, and leaves roll and pitch as estimated:
/// both frames have their z axis up. For errors that are to be compared with the covariance of
/// odometry, which is zero in these four directions where it starts.
Pose align_first(std::span<const PosePair> pairs);

}  // namespace fleetloc
