#pragma once

#include <functional>

#include "robot/vio/window_graph.hpp"
#include "test/unit/vio/simulated_vio.hpp"

namespace fleetloc {

inline SimulatedRun::Config noisy_run() {
  SimulatedRun::Config config;
  config.imu_white_noise = true;
  config.pixel_sigma = 0.5;
  return config;
}

/// Appends a keyframe with this state.
inline void append(const SimulatedRun& run,
                   const KeyframeInput& input,
                   const NavState& state,
                   WindowGraph& graph) {
  GraphKeyframe keyframe;
  keyframe.id = input.id;
  keyframe.stamp = input.frame.stamp;
  keyframe.pose = to_parameters(state.T_odom_body);
  keyframe.speed_bias = to_speed_bias(state);
  keyframe.observations = input.frame.observations;
  if (!graph.keyframes.empty()) {
    keyframe.from_previous.emplace(input.imu, ImuBias{}, run.noise());
  }
  append(graph, std::move(keyframe));
}

/// A window of five keyframes over a run that has slid a few times, so that states of its prior
/// have moved away from their first estimates. `before` is called with it before each optimization.
inline WindowGraph slid_graph(const SimulatedRun& run,
                              const SlidingWindow::Config& config,
                              const std::function<void(WindowGraph&)>& before = {}) {
  WindowGraph graph;
  const Initialization start = true_initialization(run, 40, 4, 6);
  graph.stereo = run.stereo();
  for (std::size_t i = 0; i < start.keyframes.size(); ++i) {
    append(run, start.keyframes[i], start.states[i], graph);
  }
  for (int i = 4; i < 12; ++i) {
    const int frame = 40 + 6 * i;
    append(run,
           keyframe_input(run, frame, frame - 6, static_cast<std::uint32_t>(i)),
           run.truth(run.frame_stamp(frame)),
           graph);
    triangulate_inactive(graph, {config.min_disparity_px, config.max_depth_m});
    if (before) before(graph);
    optimize(graph, config);
    if (i >= 6) {
      marginalize_oldest(graph, config);
    }
  }
  return graph;
}

}  // namespace fleetloc
