#pragma once

#include <optional>
#include <string_view>

#include "robot/odometry/visual_inertial_odometry.hpp"
#include "robot/sensors/given_pose.hpp"
#include "shared/core/expected.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/model/session.hpp"

namespace fleetloc {

/// Uncertainty of a start pose of which nothing else is said, along the axes of the map.
struct StartUncertainty {
  double position_sigma_m;
  double yaw_sigma_rad;
  double tilt_sigma_rad;  ///< of roll and pitch
  /// After a reset a start with a larger sigma is not sent to the localizer, which could converge
  /// to a wrong pose nearby with high confidence.
  double max_carried_sigma_m;
};

/// T_map_odom of a robot at T_odom_body that is known to be at T_map_body.
/// @param covariance_map  of T_map_body, perturbed along the axes of the map
MapOdomEstimate map_odom_estimate_at(const Pose& T_map_body,
                                     const Pose& T_odom_body,
                                     const Matrix6d& covariance_map);

/// Along the axes of the map.
Matrix6d covariance(const StartUncertainty& sigma);
/// Why a session has no start pose.
enum class NoStart {
  kUnknown,       ///< nobody has ever told where the robot is
  kTooUncertain,  ///< see StartUncertainty
};

/// Name of their count in files: "unknown_starts", "withheld_starts".
std::string_view name(NoStart reason);

/// Where a session of the cloud starts: from the answers so far, or else from the session before,
/// or else from the pose that somebody has given.
class SessionStart {
 public:
  /// @param T_map_body  as given at the start, at the first frame of all
  /// @param imu_gaps  bounds of the motion that nothing has observed
  SessionStart(std::optional<Pose> T_map_body,
               const StartUncertainty& sigma,
               const ImuGapModel& imu_gaps);

  /// Frames that were tracked, in order: only the first one counts.
  void note_frame(Timestamp stamp);

  /// The robot is at this pose, whatever was known before. Its tilt is the odometry's, which knows
  /// where down is: people tell a place and a heading.
  /// @param T_odom_body  at its stamp
  /// @return where the session starts that begins now
  MapOdomEstimate place(const GivenPose& given, const Pose& T_odom_body);

  /// The same while there has been no odometry: as far as the robot has not moved since the first
  /// frame.
  void place_before_odometry(const GivenPose& given);

  /// Of a session whose odometry has begun as `begin` tells.
  /// @param T_odom_body  the newest keyframe of its first window
  /// @param from_answers  T_map_odom as fused, where an answer was ever applied
  expected<MapOdomEstimate, NoStart> of_session(const OdometryStart& begin,
                                                const Pose& T_odom_body,
                                                const std::optional<MapOdomEstimate>& from_answers);

 private:
  [[nodiscard]] bool is_certain_enough(const MapOdomEstimate& start, const Pose& T_odom_body) const;
  [[nodiscard]] MapOdomEstimate from_first_pose(const OdometryStart& begin) const;

  struct FirstPose {
    Pose T_map_body;  // at the first frame
    Matrix6d covariance_map;
    bool is_placed = false;  // by somebody, at some time since
  };

  std::optional<FirstPose> first_pose_;
  StartUncertainty sigma_;
  ImuGapModel imu_gaps_;
  std::optional<Timestamp> first_frame_;
  std::optional<MapOdomEstimate> latest_;  // of the session before
};

}  // namespace fleetloc
