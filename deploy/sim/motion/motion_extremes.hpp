#pragma once

#include "deploy/sim/motion/spline_motion.hpp"

namespace fleetloc {

/// Magnitudes of a motion, as limits or as greatest values.
struct MotionMagnitudes {
  double speed = 0.0;                 ///< [m/s]
  double acceleration = 0.0;          ///< [m/s^2]
  double turn_rate = 0.0;             ///< [rad/s]
  double angular_acceleration = 0.0;  ///< [rad/s^2]
};

MotionMagnitudes magnitudes(const MotionState& state);

/// The greater of both in each.
MotionMagnitudes greatest(const MotionMagnitudes& a, const MotionMagnitudes& b);

/// The greatest values of the whole motion, sampled four times between two knots.
MotionMagnitudes extremes(const SplineMotion& motion);

/// Path length of the body, sampled likewise [m].
double length_m(const SplineMotion& motion);

}  // namespace fleetloc
