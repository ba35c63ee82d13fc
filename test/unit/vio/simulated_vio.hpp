#pragma once

#include <string>
#include <vector>

#include "deploy/sim/room/simulated_run.hpp"
#include "robot/vio/vio_config.hpp"

namespace fleetloc {

/// Section `vio` of robot.yaml, with noise as SimulatedRun makes it.
VioConfig simulated_vio_config(double pixel_sigma = 1.0);

/// A state and the truth, in an odom whose yaw and position are those of the truth at the oldest
/// keyframe of the first window.
struct CheckedState {
  Vector15d error = Vector15d::Zero();  ///< truth - estimate, in the tangent
  Matrix15d covariance = Matrix15d::Zero();

  [[nodiscard]] double nees() const;
  [[nodiscard]] double nees(int begin, int size) const;  ///< of some of the 15
  [[nodiscard]] double position_error() const { return error.segment<3>(3).norm(); }
  [[nodiscard]] double rotation_error() const { return error.head<3>().norm(); }
};

struct PlayedRun {
  std::optional<Initialization> initialization;
  double initialized_s = 0.0;
  std::vector<CheckedState> frames;     ///< of the frame estimator
  std::vector<CheckedState> keyframes;  ///< newest of the window, after its optimization
  std::vector<WindowEstimate> windows;
  Pose T_first_newest_truth;
};

/// Tracking, initializer, window and frame estimator in one thread; a keyframe is in the window
/// before the next frame.
PlayedRun play(const SimulatedRun& run, const VioConfig& config, double seconds);

/// Keyframes at `interval` frames, with the true states, for a window without an initializer.
Initialization true_initialization(const SimulatedRun& run, int first, int count, int interval);

KeyframeInput keyframe_input(const SimulatedRun& run, int frame, int previous, std::uint32_t id);

}  // namespace fleetloc
