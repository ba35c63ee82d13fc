#pragma once

#include <cmath>

#include "deploy/sim/room/simulated_run.hpp"
#include "robot/inertial/preintegration.hpp"
#include "shared/geometry/so3.hpp"

namespace fleetloc {

inline Timestamp at_second(double time_s) {
  return Timestamp{Duration{std::llround(time_s * 1e9)}};
}

inline SimulatedRun::Config lively() {
  SimulatedRun::Config config;
  config.landmarks = 0;
  config.initial_bias.gyroscope = {0.01, -0.02, 0.015};
  config.initial_bias.accelerometer = {0.1, 0.05, -0.08};
  return config;
}

/// [rotation, position, velocity] from `a` to `b`, as the error of Preintegration is defined.
inline Vector9d difference(const Preintegration::Deltas& a, const Preintegration::Deltas& b) {
  Vector9d result;
  result << log_so3(a.R.conjugate() * b.R), b.p - a.p, b.v - a.v;
  return result;
}

inline ImuBias plus(const ImuBias& bias, const Vector6d& change) {
  return {bias.gyroscope + change.head<3>(), bias.accelerometer + change.tail<3>()};
}

/// Tangent of NavState.
inline NavState plus(const NavState& state, const Vector15d& change) {
  return {retract(state.T_odom_body, change.head<6>()),
          state.v_odom + change.segment<3>(6),
          plus(state.bias, Vector6d(change.tail<6>()))};
}

}  // namespace fleetloc
