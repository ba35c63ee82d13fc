#pragma once

#include "shared/geometry/pose.hpp"
#include "shared/model/session.hpp"

namespace fleetloc {

/// Uncertainty of a start pose given by the user, along the axes of the map.
struct StartUncertainty {
  double position_sigma_m;
  double yaw_sigma_rad;
  double tilt_sigma_rad;  ///< of roll and pitch
  /// After a reset a start with a larger sigma is not sent to the localizer, which could converge
  /// to a wrong pose nearby with high confidence.
  double max_carried_sigma_m;
};

/// T_map_odom of a robot at T_odom_body that is known to be at T_map_body.
MapOdomEstimate map_odom_estimate_at(const Pose& T_map_body,
                                     const Pose& T_odom_body,
                                     const StartUncertainty& sigma);

}  // namespace fleetloc
