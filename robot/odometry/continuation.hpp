#pragma once

#include <map>
#include <optional>

#include "robot/vio/sliding_window.hpp"
#include "shared/model/pose_estimate.hpp"
#include "shared/model/session.hpp"

namespace fleetloc {

/// Lets a new odometry go on where the failed one had been carried to by dead reckoning.
class Continuation {
 public:
  /// The pose of a frame while there is no odometry; stamps increase.
  void add(const PoseEstimate& dead_reckoned);

  /// continue_from() the pose at the oldest keyframe of a new initialization, and forgets all.
  /// @return that pose; nothing, so that odom begins anew, if there is none or its heading is
  ///     unknown
  std::optional<PoseEstimate> apply(Initialization& initialization);

 private:
  std::map<Timestamp, PoseEstimate> dead_reckoned_;
};

/// The turn about z that brings `from` as close to `to` as such a turn can.
Eigen::Quaterniond yaw_between(const Eigen::Quaterniond& from, const Eigen::Quaterniond& to);

/// Transforms a new initialization in yaw and position so that its oldest keyframe is at the
/// dead-reckoned pose: odom stays continuous, with that pose's uncertainty as drift.
void continue_from(const PoseEstimate& dead_reckoned, Initialization& initialization);

/// T_map_odom after continue_from, from a dead-reckoned estimate with a map pose; T_odom_body is
/// the new odometry's at the same stamp. Yaw and position are carried. The tilt was lost, and the
/// new odometry knows where down is: T_map_odom has none, and its covariance says nothing of it.
MapOdomEstimate continued_alignment(const PoseEstimate& dead_reckoned, const Pose& T_odom_body);

/// The same without a map pose: the session's start, with the drift of yaw and position since added
/// to its covariance.
MapOdomEstimate continued_start(const MapOdomEstimate& start, const PoseEstimate& dead_reckoned);

}  // namespace fleetloc
