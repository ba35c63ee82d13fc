#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "shared/core/time.hpp"
#include "shared/geometry/pose.hpp"

namespace fleetloc {

struct StampedPose {
  Timestamp stamp;
  Pose T_ref_body;  ///< ref: the trajectory's frame, e.g. odom or map
};

/// Poses of the body in one frame; stamps strictly increase.
using Trajectory = std::vector<StampedPose>;

/// The pose at `stamp` between its two neighbours: position linear, rotation along the shortest arc
/// at constant speed. Nothing outside of the trajectory, nor in a gap longer than `max_gap`.
std::optional<Pose> interpolate(const Trajectory& trajectory, Timestamp stamp, Duration max_gap);

/// Ground truth and estimate of one instant, each in its own frame.
struct PosePair {
  Timestamp stamp;
  Pose T_truth_body;
  Pose T_estimate_body;
};

/// All poses of the estimate for which the ground truth can be interpolated.
std::vector<PosePair> associate(const Trajectory& truth,
                                const Trajectory& estimate,
                                Duration max_gap);

/// Share of the increasing `stamps` for which `estimate` holds a pose not farther away than
/// `tolerance`, 0..1; 0 without stamps.
double coverage(std::span<const Timestamp> stamps, const Trajectory& estimate, Duration tolerance);

}  // namespace fleetloc
