#include "robot/pipeline/robot_pipeline.hpp"

#include <utility>

#include "robot/inertial/preintegration.hpp"
#include "robot/vio/vio_config.hpp"
#include "shared/config/config_reader.hpp"

namespace fleetloc {
namespace {

// More frames than this waiting for the IMU mean that it has stopped: the oldest are given up.
constexpr std::size_t kMaxPending = 4;

}  // namespace

RobotPipeline::RobotPipeline(RobotSetup setup,
                             const Config& config,
                             BackEnd& back_end,
                             MapLocalizer* localizer,
                             CpuClock cpu_clock)
    : setup_(std::move(setup)),
      config_(config),
      stereo_(rectified(setup_.calibration)),
      back_end_(back_end),
      localizer_(localizer),
      cpu_clock_(std::move(cpu_clock)),
      tracker_(setup_.calibration, config.tracking),
      initializer_(stereo_, setup_.imu_noise, config.initializer),
      frame_estimator_(stereo_, setup_.imu_noise, config.frame_estimator),
      fusion_(make_pose_fusion(inflated(setup_.imu_noise, config.frame_estimator.noise),
                               config.fusion)) {}

PoseEstimate RobotPipeline::add_imu(const ImuSample& sample) {
  ++imu_samples_;
  if (!imu_.add(sample)) ++refused_imu_samples_;
  const Duration begin = cpu_clock_ ? cpu_clock_() : Duration{};
  PoseEstimate pose = fusion_->add_imu(sample);
  if (cpu_clock_) fusion_cpu_ += cpu_clock_() - begin;
  process_pending();
  return pose;
}

void RobotPipeline::add_images(StereoFrame frame) {
  add_frame(std::move(frame));
}

void RobotPipeline::add_tracks(TrackedFrame frame) {
  add_frame(std::move(frame));
}

void RobotPipeline::add_frame(Frame frame) {
  pending_.push_back(std::move(frame));
  process_pending();
  if (pending_.size() > kMaxPending) pending_.pop_front();
}

void RobotPipeline::poll(Timestamp now) {
  take_back_end(now);
  take_cloud(now);
}

void RobotPipeline::process_pending() {
  const auto stamp = [](const auto& frame) { return frame.stamp; };
  while (!pending_.empty() && imu_.covers(std::visit(stamp, pending_.front()))) {
    Frame frame = std::move(pending_.front());
    pending_.pop_front();
    frames_.push_back(take_frame(std::move(frame)));
  }
}

FrameOutput RobotPipeline::take_frame(Frame frame) {
  const Duration begin = cpu_clock_ ? cpu_clock_() : Duration{};
  const TrackedFrame tracks = tracked(std::move(frame));
  FrameOutput output{
      .stamp = tracks.stamp, .pose = {}, .tracks = static_cast<int>(tracks.observations.size())};
  if (!first_frame_) first_frame_ = tracks.stamp;
  if (window_) {
    output.keyframe = estimate(tracks);
  } else if (!initialization_) {
    initialize(tracks);
  }
  previous_frame_ = tracks.stamp;
  if (cpu_clock_) output.tracking_cpu = cpu_clock_() - begin;
  if (const auto pose = fusion_->estimate_at(tracks.stamp)) output.pose = *pose;
  output.pose.stamp = tracks.stamp;
  return output;
}

TrackedFrame RobotPipeline::tracked(Frame frame) {
  if (auto* tracks = std::get_if<TrackedFrame>(&frame)) return std::move(*tracks);
  const auto& images = std::get<StereoFrame>(frame);
  return tracker_.track(images, predicted_rotation(images.stamp));
}

void RobotPipeline::initialize(const TrackedFrame& frame) {
  std::vector<ImuSample> since_previous;
  if (previous_frame_) since_previous = imu_.between(*previous_frame_, frame.stamp);
  imu_.forget_before(frame.stamp);
  auto initialization = initializer_.add(frame, since_previous);
  if (!initialization) return;
  initialization_ = *initialization;
  newest_keyframe_ = initialization->keyframes.back().frame.stamp;
  next_keyframe_ = static_cast<std::uint32_t>(initialization->keyframes.back().id) + 1;
  back_end_.start(std::move(*initialization), frame.stamp);
  back_end_busy_ = true;
}

bool RobotPipeline::estimate(const TrackedFrame& frame) {
  const auto result = frame_estimator_.estimate(frame, imu_);
  if (!result) return false;
  fusion_->add_odometry(result->estimate);
  if (!result->wants_keyframe || back_end_busy_) return false;
  auto imu = imu_.between(newest_keyframe_, frame.stamp);
  if (imu.empty()) return false;
  KeyframeInput keyframe{.id = KeyframeId{next_keyframe_++}, .frame = frame, .imu = std::move(imu)};
  if (localizer_ != nullptr && !setup_.align_once) {
    keyframe.correction = localizer_->take_correction();
  }
  back_end_.start(std::move(keyframe), frame.stamp);
  frame_estimator_.keyframe_made(frame, result->estimate.state);
  back_end_busy_ = true;
  newest_keyframe_ = frame.stamp;
  return true;
}

void RobotPipeline::take_back_end(Timestamp now) {
  auto result = back_end_.take(now);
  if (!result) return;
  back_end_busy_ = false;
  back_end_cpu_.push_back(result->cpu);
  const bool first = window_ == nullptr;
  window_ = std::move(result->window);
  corrections_applied_ += static_cast<std::uint64_t>(window_->diagnostics.corrections_applied);
  corrections_ignored_ += static_cast<std::uint64_t>(window_->diagnostics.corrections_ignored);
  frame_estimator_.update(window_);
  if (first) fuse_first_window();
  imu_.forget_before(window_->keyframes.back().stamp);
  ++submaps_built_;
  if (localizer_ == nullptr) return;
  if (first) start_session(now);
  localizer_->submit(std::move(result->submap), now);
}

// The cloud will answer for this keyframe too, so fusion must know it.
void RobotPipeline::fuse_first_window() {
  const WindowKeyframe& newest = window_->keyframes.back();
  fusion_->reset(setup_.session);
  fusion_->add_odometry({newest.stamp, newest.state, window_->covariance});
}

void RobotPipeline::take_cloud(Timestamp now) {
  if (localizer_ == nullptr) return;
  for (Answer& answer : localizer_->take_answers(now)) {
    AnswerOutput output{.answer = std::move(answer), .arrival = now, .reason = {}};
    if (setup_.align_once && aligned_) {
      output.reason = "aligned_once";
    } else {
      const auto verdict = fusion_->add_answer(output.answer);
      output.applied = verdict.applied;
      output.reason = verdict.reason;
      aligned_ = aligned_ || verdict.applied;
      const auto start = verdict.applied ? fusion_->start_pose() : std::nullopt;
      if (start) localizer_->update_start(*start);
    }
    answers_.push_back(std::move(output));
  }
}

void RobotPipeline::start_session(Timestamp now) {
  RobotSession session;
  session.robot = setup_.id;
  session.session = setup_.session;
  session.start_stamp = setup_.program_start;
  session.stereo = stereo_;
  if (setup_.T_map_body && initialization_->T_first_newest) {
    session.start = start_pose(*setup_.T_map_body * *initialization_->T_first_newest);
  }
  localizer_->start_session(session, now);
}

// A person's start pose holds at the first image; where the motion since then was not seen, there
// is none.
StartPose RobotPipeline::start_pose(const Pose& T_map_body) const {
  const Pose& T_odom_body = initialization_->states.back().T_odom_body;
  return start_pose_at(T_map_body, T_odom_body, config_.start);
}

// From the gyroscope alone; nothing where the IMU has a gap.
Eigen::Quaterniond RobotPipeline::predicted_rotation(Timestamp stamp) const {
  if (!previous_frame_) return Eigen::Quaterniond::Identity();
  const std::vector<ImuSample> samples = imu_.between(*previous_frame_, stamp);
  if (samples.size() < 2) return Eigen::Quaterniond::Identity();
  const ImuBias bias = window_ ? window_->keyframes.back().state.bias : ImuBias{};
  return Preintegration(samples, bias, setup_.imu_noise).deltas(bias).R;
}

RobotPipeline::Config read_robot_pipeline_config(ConfigReader config) {
  constexpr double kRadPerDeg = 3.14159265358979323846 / 180.0;
  const VioConfig vio = read_vio_config(config.section("vio"));
  ConfigReader start = config.section("start");
  return {.tracking = read_feature_tracker_config(config.section("tracking")),
          .initializer = vio.initializer,
          .frame_estimator = vio.frame_estimator,
          .fusion = read_pose_fusion_config(config.section("fusion")),
          .start = {.position_sigma_m = start.positive("position_sigma_m"),
                    .yaw_sigma_rad = start.positive("yaw_sigma_deg") * kRadPerDeg,
                    .tilt_sigma_rad = start.positive("tilt_sigma_deg") * kRadPerDeg}};
}

KeyframeWorker::Config read_keyframe_worker_config(ConfigReader config) {
  return {.window = read_vio_config(config.section("vio")).window,
          .submap = read_submap_builder_config(config.section("submap"))};
}

}  // namespace fleetloc
