#include "deploy/sim/motion/motion_extremes.hpp"

#include <algorithm>

namespace fleetloc {
namespace {

constexpr int kSamplesPerInterval = 4;

template <typename Visit>
void for_each_state(const SplineMotion& motion, const Visit& visit) {
  const SplineGrid& grid = motion.grid();
  for (int i = 0; i <= kSamplesPerInterval * grid.intervals; ++i) {
    visit(motion.at(grid.interval_s * i / kSamplesPerInterval));
  }
}

}  // namespace

MotionMagnitudes magnitudes(const MotionState& state) {
  return {.speed = state.v_map.norm(),
          .acceleration = state.a_map.norm(),
          .turn_rate = state.angular_velocity.norm(),
          .angular_acceleration = state.angular_acceleration.norm()};
}

MotionMagnitudes greatest(const MotionMagnitudes& a, const MotionMagnitudes& b) {
  return {.speed = std::max(a.speed, b.speed),
          .acceleration = std::max(a.acceleration, b.acceleration),
          .turn_rate = std::max(a.turn_rate, b.turn_rate),
          .angular_acceleration = std::max(a.angular_acceleration, b.angular_acceleration)};
}

MotionMagnitudes extremes(const SplineMotion& motion) {
  MotionMagnitudes result;
  for_each_state(motion,
                 [&](const MotionState& state) { result = greatest(result, magnitudes(state)); });
  return result;
}

double length_m(const SplineMotion& motion) {
  double length = 0.0;
  Eigen::Vector3d last = motion.at(0.0).T_map_body.p;
  for_each_state(motion, [&](const MotionState& state) {
    length += (state.T_map_body.p - last).norm();
    last = state.T_map_body.p;
  });
  return length;
}

}  // namespace fleetloc
