#include "deploy/sim/motion/vibration.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "shared/core/counter_random.hpp"
#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

constexpr double kVibrationKnotInterval = 0.02;  // [s]
constexpr std::array kFrequencies{1.0, 1.37, 2.21};
constexpr std::array kAmplitudes{1.0, 0.5, 0.25};

enum Axis : std::uint64_t { kHeight, kPitch, kRoll };

/// Of amplitude one at the first sine.
double shaking(double cycles, Axis axis, const CounterRandom& phases) {
  double sum = 0.0;
  for (std::size_t i = 0; i < kFrequencies.size(); ++i) {
    const double phase = phases.uniform(axis, i);
    sum += kAmplitudes[i] * std::sin(2.0 * std::numbers::pi * (kFrequencies[i] * cycles + phase));
  }
  return sum;
}

}  // namespace

SplineMotion with_vibration(const SplineMotion& motion,
                            const VibrationConfig& config,
                            const Eigen::Vector3d& forward_body,
                            std::uint64_t seed) {
  constexpr std::uint64_t kPhases = 0x7669627261;
  const CounterRandom phases(seed, kPhases);
  const SplineGrid grid =
      grid_over(motion.duration(), std::min(kVibrationKnotInterval, motion.grid().interval_s));
  return spline_through(grid, [&](double time_s) {
    const MotionState state = motion.at(time_s);
    const double speed = state.v_map.norm() / config.full_from_speed;
    const double share = 1.0 - std::exp(-speed * speed);
    const double cycles = config.frequency_hz * time_s;
    Eigen::Vector3d forward = state.T_map_body.R * forward_body;
    forward.z() = 0.0;
    forward.normalize();
    const Eigen::Vector3d left = Eigen::Vector3d::UnitZ().cross(forward);
    const Eigen::Vector3d tilt = config.roll_rad * shaking(cycles, kRoll, phases) * forward +
                                 config.pitch_rad * shaking(cycles, kPitch, phases) * left;
    Pose pose = state.T_map_body;
    pose.p.z() += share * config.height_m * shaking(cycles, kHeight, phases);
    pose.R = exp_so3(share * tilt) * pose.R;
    return pose;
  });
}

}  // namespace fleetloc
