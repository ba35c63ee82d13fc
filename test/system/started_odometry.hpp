#pragma once

#include <optional>
#include <vector>

#include "shared/trajectory/trajectory.hpp"
#include "test/system/recorded_flight.hpp"

namespace fleetloc {

/// Result of odometry that was started somewhere in a recording.
struct StartOutcome {
  double start_s = 0.0;                ///< of the recording, from its first image
  std::optional<double> first_pose_s;  ///< after the start, in time of the data
  double path_m = 0.0;                 ///< true length of the stretch that the scale is taken from
  double scale_error = 1.0;            ///< metres of odom in true metres, less one
  /// Between the z axes of odom and truth, both seen from the body: at the first pose, and at the
  /// last pose before patience ends. The truth's own may be some tenths of a degree off.
  double first_gravity_error_deg = 180.0;
  double gravity_error_deg = 180.0;
};

/// Starts [s from the first image] spread evenly over the instants at which the body is faster than
/// `min_speed` [m/s] by the ground truth and `playing_s` seconds of images follow.
struct StartChoice {
  int count = 0;
  double min_speed = 0.0;
  double playing_s = 0.0;
};
std::vector<double> starts_in_motion(const RecordedFlight& flight, const StartChoice& choice);

/// Runs the robot without a map from `start_s` on, as fleetloc-replay does, until `stretch_s` after
/// its first pose, or until there was none for `patience_s`.
///
/// The scale is that of the similarity (Umeyama 1991) that takes the true positions of the stretch
/// to the odometry's: both are sampled at all frames, and errors of the odometry, being on the left
/// side of this regression, do not shift it.
struct StartWatch {
  double patience_s = 0.0;
  double stretch_s = 0.0;
};
StartOutcome started_at(double start_s, const RecordedFlight& flight, const StartWatch& watch);

}  // namespace fleetloc
