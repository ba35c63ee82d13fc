#include "robot/odometry/back_end.hpp"

#include <cassert>
#include <utility>

namespace fleetloc {
namespace {

SubmapInput submap_input(const WindowEstimate& window) {
  SubmapInput input;
  input.inertial = window.inertial;
  for (const WindowKeyframe& keyframe : window.keyframes) {
    input.keyframes.push_back({.id = keyframe.id,
                               .stamp = keyframe.stamp,
                               .tilt_sigma = keyframe.tilt_sigma,
                               .observations = keyframe.observations});
  }
  for (const auto& [id, landmark] : window.landmarks) {
    input.landmarks.push_back({.id = id,
                               .p_odom = landmark.p_odom,
                               .observations = landmark.observations,
                               .relative_depth_sigma = landmark.relative_depth_sigma});
  }
  return input;
}

}  // namespace

KeyframeWorker::KeyframeWorker(RectifiedStereo stereo,
                               const ImuNoise& noise,
                               const Config& config,
                               CpuClock cpu_clock)
    : stereo_(std::move(stereo)),
      noise_(noise),
      config_(config),
      cpu_clock_(std::move(cpu_clock)),
      builder_(config.submap) {}

KeyframeResult KeyframeWorker::run(const KeyframeJob& job) {
  const Duration begin = cpu_clock_ ? cpu_clock_() : Duration{};
  KeyframeResult result;
  result.window = std::make_shared<const WindowEstimate>(optimize(job));
  result.submap = builder_.build(submap_input(*result.window));
  result.no_edges = builder_.diagnostics().refusal;
  if (cpu_clock_) result.cpu = cpu_clock_() - begin;
  return result;
}

WindowEstimate KeyframeWorker::optimize(const KeyframeJob& job) {
  if (const auto* initialization = std::get_if<Initialization>(&job)) {
    window_.emplace(stereo_, noise_, config_.window, *initialization);
    builder_ = SubmapBuilder(config_.submap);
    return window_->estimate();
  }
  assert(window_.has_value());
  return window_->add(std::get<KeyframeInput>(job));
}

}  // namespace fleetloc
