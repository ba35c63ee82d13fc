#pragma once

#include <cstdint>
#include <span>

#include "shared/core/ids.hpp"
#include "shared/link/channel.hpp"
#include "shared/model/pose_estimate.hpp"
#include "shared/wire/malformed.hpp"

namespace fleetloc {

struct RobotPoseEstimate {
  RobotId robot;
  PoseEstimate estimate;
};

/// Exact, but for the covariances (square_root_of); that of the map pose is zero without one.
/// Throws NotEncodable for what the receiver would refuse.
Bytes encode(const RobotPoseEstimate& pose);

/// Never throws.
Decoded<RobotPoseEstimate> decode_pose_estimate(std::span<const std::uint8_t> bytes);

}  // namespace fleetloc
