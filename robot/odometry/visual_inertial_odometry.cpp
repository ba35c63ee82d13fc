#include "robot/odometry/visual_inertial_odometry.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

namespace fleetloc {
namespace {

constexpr Duration kImuKept = std::chrono::seconds(30);  // longer than any failure is bridged
constexpr Duration kNoticed = std::chrono::seconds(1);   // longer than a motion goes on unnoticed

}  // namespace

VisualInertialOdometry::VisualInertialOdometry(const StereoCalibration& calibration,
                                               const ImuNoise& imu_noise,
                                               const Config& config,
                                               BackEnd& back_end,
                                               CpuClock cpu_clock)
    : max_imu_step_(max_imu_step(config)),
      back_end_(back_end),
      cpu_clock_(std::move(cpu_clock)),
      front_end_(calibration, imu_noise, config.tracking),
      initializer_(rectified(calibration), imu_noise, config.initializer),
      frame_estimator_(rectified(calibration), imu_noise, config.frame_estimator),
      health_(config.health),
      standstill_(config.standstill),
      holds_without_place_(config.holds_without_place) {}

expected<void, ResetCause> VisualInertialOdometry::add_imu(const ImuSample& sample) {
  const bool is_gap = last_imu_ && sample.stamp - *last_imu_ > max_imu_step_;
  if (is_gap) {
    imu_ = ImuBuffer{};  // nothing may be integrated across
    ++faults_["imu_gaps"];
  }
  imu_.add(sample);
  imu_.keep(kImuKept);
  standstill_.add_imu(sample);
  last_imu_ = sample.stamp;
  const bool is_running = phase_ == Phase::kStarting || phase_ == Phase::kTracking;
  if (is_gap && is_running) return unexpected(reset(ResetCause::kImuGap));
  return {};
}

std::optional<OdometryFrame> VisualInertialOdometry::track_next() {
  if (pending_.empty()) return std::nullopt;
  const Timestamp stamp = stamp_of(pending_.front());
  const bool in_imu_gap = imu_.begins_after(stamp);
  if (!in_imu_gap && !imu_.covers(stamp)) return std::nullopt;
  CameraFrame frame = std::move(pending_.front());
  pending_.pop_front();
  if (!in_imu_gap) return track(std::move(frame));
  ++faults_["frames_in_imu_gaps"];
  return OdometryFrame{.stamp = stamp, .estimate = {}, .in_imu_gap = true, .reset = {}};
}

OdometryFrame VisualInertialOdometry::track(CameraFrame frame) {
  const Duration begin = cpu_clock_ ? cpu_clock_() : Duration{};
  std::optional<OdometryFrame> output;
  if (held_) output = stay(frame);
  if (!output) output = follow(std::move(frame));
  if (cpu_clock_) output->cpu = cpu_clock_() - begin;
  return std::move(*output);
}

// The features are compared with those of the image in which the body came to rest, so that nothing
// drifts; what moves before the camera, and what comes and goes, is as in any other image.
std::optional<OdometryFrame> VisualInertialOdometry::stay(const CameraFrame& frame) {
  const TrackedFrame tracks = front_end_.peek(frame);
  const auto result = frame_estimator_.estimate(tracks, imu_);
  if (!result || !still_since(tracks.stamp, *result)) {
    held_.reset();
    return std::nullopt;
  }
  statistics_.standstill += tracks.stamp - held_->estimate.stamp;
  held_->estimate.stamp = tracks.stamp;
  const Timestamp noticed = tracks.stamp - kNoticed;
  if (noticed > held_->since) imu_.leave_out(held_->since, noticed);
  health_.begin_anew(tracks.stamp);
  return OdometryFrame{.stamp = tracks.stamp,
                       .tracks = static_cast<int>(tracks.observations.size()),
                       .estimate = held_->estimate,
                       .reset = {}};
}

OdometryFrame VisualInertialOdometry::follow(CameraFrame frame) {
  const std::optional<Timestamp> previous = front_end_.last_stamp();
  const ImuBias bias = window_ ? window_->keyframes.back().state.bias : ImuBias{};
  const TrackedFrame tracks = front_end_.track(std::move(frame), imu_, bias);
  OdometryFrame output;
  switch (phase_) {
    case Phase::kWaiting:
    case Phase::kStarting:
      break;
    case Phase::kInitializing:
      initialize(tracks, previous);
      break;
    case Phase::kTracking:
      output = estimate(tracks);
      break;
  }
  output.stamp = tracks.stamp;
  output.tracks = static_cast<int>(tracks.observations.size());
  return output;
}

void VisualInertialOdometry::add_dead_reckoned(const PoseEstimate& pose) {
  const bool has_failed = statistics_.resets > 0;
  if (has_failed && (phase_ == Phase::kWaiting || phase_ == Phase::kInitializing)) {
    continuation_.add(pose);
  }
}

void VisualInertialOdometry::initialize(const TrackedFrame& frame,
                                        std::optional<Timestamp> previous) {
  std::vector<ImuSample> since_previous;
  if (previous) since_previous = imu_.between(*previous, frame.stamp);
  imu_.forget_before(frame.stamp);
  auto initialization = initializer_.add(frame, since_previous);
  if (initialization) return begin(std::move(*initialization));
  if (initialization.error() != NotInitialized::kCollecting) {
    ++faults_["initialization_" + std::string(name(initialization.error()))];
  }
}

void VisualInertialOdometry::begin(Initialization initialization) {
  const std::optional<PoseEstimate> continued = continuation_.apply(initialization);
  const KeyframeInput& newest = initialization.keyframes.back();
  start_ = {
      .stamp = newest.frame.stamp,
      .T_odom_body = initialization.states.back().T_odom_body,
      .T_first_newest = statistics_.resets == 0 ? initialization.T_first_newest : std::nullopt,
      .continued = continued};
  latest_keyframe_ = {.id = newest.id, .stamp = newest.frame.stamp};
  statistics_.keyframes += initialization.keyframes.size();
  const Timestamp now = newest.frame.stamp;
  back_end_.start(std::move(initialization), now);
  back_end_busy_ = true;
  phase_ = Phase::kStarting;
}

OdometryFrame VisualInertialOdometry::estimate(const TrackedFrame& frame) {
  OdometryFrame output;
  const auto result = frame_estimator_.estimate(frame, imu_);
  if (!result) {  // it is too long since the newest keyframe
    output.reset = reset(ResetCause::kVisionLost);
    return output;
  }
  if (!result->vision_updated) ++faults_["vision_lost_frames"];
  if (result->vision_inconsistent) ++faults_["vision_inconsistent_frames"];
  if (const auto healthy = health_.check(*result); !healthy) {
    output.reset = reset(healthy.error());
    return output;
  }
  output.estimate = result->estimate;
  if (const auto since = still_since(frame.stamp, *result)) hold(result->estimate, *since);
  output.keyframe = result->wants_keyframe && !back_end_busy_ && add_keyframe(frame, *result);
  return output;
}

// Since when the body stands, if its pose may be held.
std::optional<Timestamp> VisualInertialOdometry::still_since(Timestamp stamp,
                                                             const FrameEstimator::Result& result) {
  const auto since =
      standstill_.update(stamp, result.estimate.state.T_odom_body, result.vision_updated);
  const bool holds = since && (is_place_known_ || stamp - *since >= holds_without_place_);
  return holds ? since : std::nullopt;
}

void VisualInertialOdometry::hold(const OdometryEstimate& estimate, Timestamp since) {
  held_ = {.estimate = estimate, .since = std::max(since, latest_keyframe_.stamp)};
  held_->estimate.state.v_odom.setZero();
  held_->estimate.is_standing = true;
}

// False if the IMU has a gap since the keyframe before.
bool VisualInertialOdometry::add_keyframe(const TrackedFrame& frame,
                                          const FrameEstimator::Result& result) {
  auto imu = imu_.between(latest_keyframe_.stamp, frame.stamp);
  if (imu.empty()) return false;
  outlier_tracks_.add(result.outliers, frame);
  const KeyframeId id{static_cast<std::uint32_t>(latest_keyframe_.id) + 1};
  back_end_.start(KeyframeInput{.id = id,
                                .frame = outlier_tracks_.removed_from(frame),
                                .imu = std::move(imu),
                                .standstill = imu_.left_out(latest_keyframe_.stamp, frame.stamp),
                                .correction = std::exchange(correction_, std::nullopt),
                                .forgets_corrections = std::exchange(forgets_corrections_, false)},
                  frame.stamp);
  back_end_busy_ = true;
  latest_keyframe_ = {.id = id, .stamp = frame.stamp};
  frame_estimator_.set_reference_keyframe(frame, result.estimate.state);
  ++statistics_.keyframes;
  return true;
}

expected<std::optional<OdometryWindow>, ResetCause> VisualInertialOdometry::take_window(
    Timestamp now) {
  auto result = back_end_.take(now);
  if (!result) return std::nullopt;
  back_end_busy_ = false;
  statistics_.back_end_ms.add(1e3 * to_seconds(result->cpu));
  if (phase_ == Phase::kWaiting) {
    phase_ = Phase::kInitializing;
    return std::nullopt;
  }
  if (const auto healthy = health_.check(*result->window); !healthy) {
    return unexpected(reset(healthy.error()));
  }
  return adopt(std::move(*result));
}

OdometryWindow VisualInertialOdometry::adopt(KeyframeResult result) {
  OdometryWindow output{.window = std::move(result.window),
                        .submap = std::move(result.submap),
                        .start = std::exchange(start_, std::nullopt)};
  window_ = output.window;
  frame_estimator_.update(window_);
  imu_.forget_before(window_->keyframes.back().stamp);
  if (phase_ == Phase::kStarting) correction_.reset();  // it was of the session before
  phase_ = Phase::kTracking;
  ++statistics_.windows;
  if (result.no_edges) ++faults_["submap_" + std::string(name(*result.no_edges))];
  const WindowDiagnostics& diagnostics = window_->diagnostics;
  statistics_.corrections_applied += static_cast<std::uint64_t>(diagnostics.corrections_applied);
  statistics_.corrections_ignored += static_cast<std::uint64_t>(diagnostics.corrections_ignored);
  return output;
}

ResetCause VisualInertialOdometry::reset(ResetCause cause) {
  ++statistics_.resets;
  ++faults_["reset_" + std::string(name(cause))];
  phase_ = back_end_busy_ ? Phase::kWaiting : Phase::kInitializing;
  start_.reset();
  window_.reset();
  correction_.reset();
  initializer_.reset();
  frame_estimator_.reset();
  outlier_tracks_.clear();
  health_.reset();
  standstill_.reset();
  held_.reset();
  return cause;
}

std::map<std::string, std::uint64_t> VisualInertialOdometry::faults() const {
  std::map<std::string, std::uint64_t> faults = faults_;
  for (const auto& [kind, count] : front_end_.faults()) faults[kind] = count;
  return faults;
}

}  // namespace fleetloc
