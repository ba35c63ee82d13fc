#include "deploy/sim/recording/sim_tracks.hpp"

#include "deploy/sim/sensors/stereo_renderer.hpp"
#include "deploy/sim/sensors/track_simulator.hpp"
#include "robot/dataset/track_files.hpp"
#include "shared/config/progress_line.hpp"

namespace fleetloc {
namespace {

struct Instant {
  Timestamp stamp;
  double time_s = 0.0;
  Pose T_map_body;
};

Instant instant(const SimFrames& frames, const SimConfig& config, std::uint64_t frame) {
  const Duration after_start = from_seconds(static_cast<double>(frame) / config.frame_rate_hz);
  const double time_s = to_seconds(after_start);
  return {.stamp = frames.motion->start + after_start,
          .time_s = time_s,
          .T_map_body = frames.motion->motion.at(time_s).T_map_body};
}

}  // namespace

std::size_t write_tracks(const SimFrames& frames,
                         const SimConfig& config,
                         std::uint64_t seed,
                         const std::filesystem::path& folder,
                         const std::stop_token& stop) {
  TrackSimulator simulator(config.cameras, config.tracks, seed);
  TrackWriter writer(folder);
  ProgressLine progress("tracked frames");
  std::size_t done = 0;
  for (std::uint64_t i = frames.first; i < frames.end && !stop.stop_requested(); ++i) {
    const Instant now = instant(frames, config, i);
    writer.add(simulator.track(now.stamp, now.T_map_body, frames.scene->at(now.time_s)));
    progress.show(++done, frames.end - frames.first);
  }
  writer.finish();
  return done;
}

TrackComparison compare_tracks(const SimFrames& frames,
                               const SimConfig& config,
                               const FeatureTracker::Config& front_end,
                               std::uint64_t seed,
                               const std::stop_token& stop) {
  StereoRenderer renderer(config.cameras, *frames.scene, config.renderer, seed);
  FeatureTracker tracker(config.cameras, front_end);
  TrackSimulator simulator(config.cameras, config.tracks, seed);
  TrackAssessment simulated(rectified(config.cameras));
  TrackAssessment tracked(rectified(config.cameras));
  const auto T_map_body_at = [&](double s) { return frames.motion->motion.at(s).T_map_body; };
  Eigen::Quaterniond R_map_previous = instant(frames, config, frames.first).T_map_body.R;
  ProgressLine progress("compared frames");
  for (std::uint64_t i = frames.first; i < frames.end && !stop.stop_requested(); ++i) {
    const Instant now = instant(frames, config, i);
    const SceneView view = frames.scene->at(now.time_s);
    simulated.add(simulator.track(now.stamp, now.T_map_body, view), now.T_map_body, view);
    const StereoFrame images =
        renderer.render({.stamp = now.stamp, .time_s = now.time_s, .frame = i}, T_map_body_at);
    const Eigen::Quaterniond R_map_body = now.T_map_body.R;
    tracked.add(tracker.track(images, R_map_previous.inverse() * R_map_body), now.T_map_body, view);
    R_map_previous = R_map_body;
    progress.show(i + 1 - frames.first, frames.end - frames.first);
  }
  return {.simulated = simulated.statistics(), .tracked = tracked.statistics()};
}

}  // namespace fleetloc
