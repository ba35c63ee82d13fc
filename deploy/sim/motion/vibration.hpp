#pragma once

#include <cstdint>

#include "deploy/sim/motion/spline_motion.hpp"

namespace fleetloc {

/// Vibration of a robot that walks or rolls: height, pitch and roll, each a sum of three sines of
/// random phase with 1, 1.37 and 2.21 times the frequency. It fades out at rest.
struct VibrationConfig {
  double height_m = 0.0;  ///< amplitude (of the first sine; the others have a half and a quarter)
  double pitch_rad = 0.0;
  double roll_rad = 0.0;
  double frequency_hz = 2.0;
  double full_from_speed = 0.5;  ///< two thirds of the amplitude at this speed [m/s]
};

/// The motion with a vibration in map's z and about the horizontal axes of the robot's heading (the
/// direction of `forward_body` seen from above). Its knots are no more than 0.02 s apart.
/// @param forward_body  forward axis of the robot, in the body frame
SplineMotion with_vibration(const SplineMotion& motion,
                            const VibrationConfig& config,
                            const Eigen::Vector3d& forward_body,
                            std::uint64_t seed);

}  // namespace fleetloc
