#include "robot/pipeline/robot_pipeline.hpp"

#include <cmath>
#include <utility>

#include <Eigen/Eigenvalues>

#include "robot/inertial/preintegration.hpp"
#include "robot/pipeline/continuation.hpp"

namespace fleetloc {
namespace {

// Initializations look back less far than this.
constexpr Duration kDeadReckonedFor = std::chrono::seconds(30);

Duration max_imu_step(const RobotPipeline::Config& config) {
  return from_seconds(config.frame_estimator.noise.imu_gaps.void_from_s);
}

TrackedFrame without(TrackedFrame frame, const std::set<LandmarkId>& landmarks) {
  std::erase_if(frame.observations,
                [&](const StereoObservation& seen) { return landmarks.contains(seen.landmark); });
  return frame;
}

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
      input_validator_(max_imu_step(config)),
      tracker_(setup_.calibration, config.tracking),
      initializer_(stereo_, setup_.imu_noise, config.initializer),
      frame_estimator_(stereo_, setup_.imu_noise, config.frame_estimator),
      health_(config.health),
      fusion_(make_pose_fusion(inflated(setup_.imu_noise, config.frame_estimator.noise),
                               config.fusion)) {}

std::optional<PoseEstimate> RobotPipeline::add_imu(const ImuSample& sample) {
  const std::vector<ImuSample> admitted = input_validator_.admit(sample);
  for (const ImuSample& one : admitted) handle_imu(one);
  if (admitted.empty()) return std::nullopt;
  handle_pending();
  return latest_pose_;
}

void RobotPipeline::handle_imu(const ImuSample& sample) {
  if (imu_samples_ > 0 && sample.stamp - latest_pose_.stamp > max_imu_step(config_)) {
    imu_ = ImuBuffer{};  // nothing may be integrated across
    ++faults_["imu_gaps"];
    if (initialization_) reset(ResetCause::kImuGap);
  }
  ++imu_samples_;
  imu_.add(sample);
  const Duration begin = cpu_clock_ ? cpu_clock_() : Duration{};
  latest_pose_ = fusion_->add_imu(sample);
  if (cpu_clock_) fusion_cpu_ += cpu_clock_() - begin;
}

void RobotPipeline::add_images(StereoFrame frame) {
  add_frame(std::move(frame));
}

void RobotPipeline::add_tracks(TrackedFrame frame) {
  add_frame(std::move(frame));
}

void RobotPipeline::add_frame(CameraFrame frame) {
  const Timestamp stamp = stamp_of(frame);
  if (const std::string_view reason = input_validator_.check_frame(stamp); !reason.empty()) {
    frames_.push_back({.stamp = stamp, .pose = {}, .refused = reason});
    return;
  }
  pending_.push_back(std::move(frame));
  handle_pending();
}

void RobotPipeline::poll(Timestamp now) {
  poll_back_end(now);
  poll_cloud(now);
}

void RobotPipeline::handle_pending() {
  while (!pending_.empty()) {
    const Timestamp stamp = stamp_of(pending_.front());
    const bool lost_to_gap = imu_.begins_after(stamp);
    if (!lost_to_gap && !imu_.covers(stamp)) return;
    CameraFrame frame = std::move(pending_.front());
    pending_.pop_front();
    frames_.push_back(lost_to_gap ? skip_frame(stamp) : handle_frame(std::move(frame)));
  }
}

FrameOutput RobotPipeline::handle_frame(CameraFrame frame) {
  const Duration begin = cpu_clock_ ? cpu_clock_() : Duration{};
  const TrackedFrame tracks = tracked(std::move(frame));
  FrameOutput output{.stamp = tracks.stamp,
                     .pose = {},
                     .refused = {},
                     .tracks = static_cast<int>(tracks.observations.size())};
  if (!first_frame_) first_frame_ = tracks.stamp;
  if (window_) {
    output.keyframe = estimate(tracks);
  } else if (!initialization_) {
    initialize(tracks);
  }
  previous_frame_ = tracks.stamp;
  if (cpu_clock_) output.tracking_cpu = cpu_clock_() - begin;
  output.pose = pose_at(tracks.stamp);
  output.resets = resets_;
  return output;
}

// Without IMU samples around it a frame cannot be used, but has a dead-reckoned pose.
FrameOutput RobotPipeline::skip_frame(Timestamp stamp) {
  ++faults_["frames_in_imu_gaps"];
  return {.stamp = stamp, .pose = pose_at(stamp), .refused = {}, .resets = resets_};
}

// Outside of fusion's buffer the pose at the newest IMU sample, the first one after the frame.
PoseEstimate RobotPipeline::pose_at(Timestamp stamp) const {
  PoseEstimate pose = fusion_->estimate_at(stamp).value_or(latest_pose_);
  pose.stamp = stamp;
  return pose;
}

TrackedFrame RobotPipeline::tracked(CameraFrame frame) {
  if (auto* tracks = std::get_if<TrackedFrame>(&frame)) return std::move(*tracks);
  auto& images = std::get<StereoFrame>(frame);
  check_image(images.left, setup_.calibration.cam0);
  check_image(images.right, setup_.calibration.cam1);
  return tracker_.track(images, predicted_rotation(images.stamp));
}

void RobotPipeline::check_image(cv::Mat& image, const Camera& camera) {
  if (image.empty()) {
    ++faults_["missing_images"];
  } else if (image.type() != CV_8UC1 || image.cols != camera.width_px ||
             image.rows != camera.height_px) {
    ++faults_["wrong_images"];
    image = cv::Mat();
  }
}

void RobotPipeline::initialize(const TrackedFrame& frame) {
  if (resets_ > 0) {
    dead_reckoned_[frame.stamp] = pose_at(frame.stamp);
    dead_reckoned_.erase(dead_reckoned_.begin(),
                         dead_reckoned_.lower_bound(frame.stamp - kDeadReckonedFor));
  }
  if (back_end_busy_) return;  // with a job of the session before
  std::vector<ImuSample> since_previous;
  if (previous_frame_) since_previous = imu_.between(*previous_frame_, frame.stamp);
  imu_.forget_before(frame.stamp);
  auto initialization = initializer_.add(frame, since_previous);
  if (!initialization) return;
  const auto before = dead_reckoned_.find(initialization->keyframes.front().frame.stamp);
  if (before != dead_reckoned_.end() && before->second.quality != Quality::kInitializing) {
    continued_ = before->second;
    continue_from(*continued_, *initialization);
  }
  dead_reckoned_.clear();
  initialization_ = *initialization;
  newest_keyframe_ = initialization->keyframes.back().frame.stamp;
  next_keyframe_ = static_cast<std::uint32_t>(initialization->keyframes.back().id) + 1;
  keyframes_ += initialization->keyframes.size();
  back_end_.start(std::move(*initialization), frame.stamp);
  back_end_busy_ = true;
}

bool RobotPipeline::estimate(const TrackedFrame& frame) {
  const auto result = frame_estimator_.estimate(frame, imu_);
  if (!result) return false;
  if (!result->vision_updated) ++faults_["vision_lost_frames"];
  if (result->vision_inconsistent) ++faults_["vision_inconsistent_frames"];
  if (const auto cause = health_.check(*result)) {
    reset(*cause);
    return false;
  }
  fusion_->add_odometry(result->estimate);
  if (!result->wants_keyframe || back_end_busy_) return false;
  auto imu = imu_.between(newest_keyframe_, frame.stamp);
  if (imu.empty()) return false;
  remember_outliers(result->outliers, frame);
  KeyframeInput keyframe{.id = KeyframeId{next_keyframe_++},
                         .frame = without(frame, outlier_tracks_),
                         .imu = std::move(imu)};
  if (localizer_ != nullptr && !setup_.align_once) {
    keyframe.correction = localizer_->take_correction();
  }
  back_end_.start(std::move(keyframe), frame.stamp);
  ++keyframes_;
  frame_estimator_.set_reference_keyframe(frame, result->estimate.state);
  back_end_busy_ = true;
  newest_keyframe_ = frame.stamp;
  return true;
}

// Outliers (moving points, wrong tracks) are excluded for as long as they are tracked.
void RobotPipeline::remember_outliers(const std::vector<LandmarkId>& outliers,
                                      const TrackedFrame& frame) {
  std::set<LandmarkId> tracked;
  for (const StereoObservation& seen : frame.observations) tracked.insert(seen.landmark);
  std::erase_if(outlier_tracks_, [&](LandmarkId id) { return !tracked.contains(id); });
  outlier_tracks_.insert(outliers.begin(), outliers.end());
}

void RobotPipeline::reset(ResetCause cause) {
  ++resets_;
  ++faults_["reset_" + std::string(name(cause))];
  setup_.session = SessionNumber{static_cast<std::uint32_t>(setup_.session) + 1};
  window_.reset();
  initialization_.reset();
  continued_.reset();
  discard_result_ = back_end_busy_;
  initializer_ = Initializer(stereo_, setup_.imu_noise, config_.initializer);
  frame_estimator_ = FrameEstimator(stereo_, setup_.imu_noise, config_.frame_estimator);
  outlier_tracks_.clear();
  health_.reset();
  fusion_->interrupt();
}

void RobotPipeline::poll_back_end(Timestamp now) {
  auto result = back_end_.take(now);
  if (!result) return;
  back_end_busy_ = false;
  back_end_ms_.add(1e3 * to_seconds(result->cpu));
  if (std::exchange(discard_result_, false)) return;
  if (const auto cause = health_.check(*result->window)) return reset(*cause);
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
  if (const auto start = current_start()) localizer_->update_start(*start);
  localizer_->submit(std::move(result->submap), now);
}

// The cloud may answer for this keyframe, so fusion needs its odometry.
void RobotPipeline::fuse_first_window() {
  std::optional<MapOdomEstimate> carried;
  if (continued_ && continued_->T_map_body) {
    carried = continued_alignment(*continued_, window_->keyframes.front().state.T_odom_body);
  }
  fusion_->reset(setup_.session, carried);
  const WindowKeyframe& newest = window_->keyframes.back();
  fusion_->add_odometry({newest.stamp, newest.state, window_->covariance});
}

void RobotPipeline::poll_cloud(Timestamp now) {
  if (localizer_ == nullptr) return;
  for (LocalizationResult& answer : localizer_->take_answers(now)) {
    LocalizationOutput output{.answer = std::move(answer), .arrival = now, .reason = {}};
    if (setup_.align_once && aligned_) {
      output.reason = "aligned_once";
    } else {
      const auto verdict = fusion_->add_answer(output.answer);
      output.applied = verdict.applied;
      output.reason = verdict.reason;
      aligned_ = aligned_ || verdict.applied;
    }
    if (output.applied) localizer_->note_applied();
    answers_.push_back(std::move(output));
  }
}

void RobotPipeline::start_session(Timestamp now) {
  RobotSession session;
  session.robot = setup_.id;
  session.session = setup_.session;
  session.start_stamp = setup_.program_start;
  session.stereo = stereo_;
  if (const auto alignment = current_start()) {
    start_ = alignment;
  } else if (continued_ && start_) {
    start_ = continued_start(*start_, *continued_);
  } else if (setup_.T_map_body) {
    start_ = start_from_initial_pose(*setup_.T_map_body);
  }
  if (start_ && is_usable(*start_)) {
    session.start = start_;
  } else if (start_) {
    ++faults_["withheld_starts"];
  }
  localizer_->start_session(session, now);
}

// Nothing before the first applied answer, or if it is older than a gap in the IMU's data.
std::optional<MapOdomEstimate> RobotPipeline::current_start() const {
  auto start = fusion_->session_start();
  if (start) start->p_odom = window_->keyframes.back().state.T_odom_body.p;
  return start;
}

bool RobotPipeline::is_usable(const MapOdomEstimate& start) const {
  if (resets_ == 0 && initialization_->T_first_newest) return true;  // as given by the user
  const Matrix6d A = adjoint(inverse(window_->keyframes.back().state.T_odom_body));
  const Matrix6d covariance = A * start.covariance * A.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance.bottomRightCorner<3, 3>(),
                                                              Eigen::EigenvaluesOnly);
  return std::sqrt(solver.eigenvalues().maxCoeff()) <= config_.start.max_carried_sigma_m;
}

// The user's start pose refers to the first image. Where the motion since then was not observed,
// its bounds (ImuGapModel) are added.
MapOdomEstimate RobotPipeline::start_from_initial_pose(const Pose& T_map_body_first) const {
  const Pose& T_odom_body = initialization_->states.back().T_odom_body;
  const std::optional<Pose>& T_first_newest = initialization_->T_first_newest;
  if (T_first_newest && resets_ == 0) {
    return map_odom_estimate_at(T_map_body_first * *T_first_newest, T_odom_body, config_.start);
  }
  const ImuGapModel& bounds = config_.frame_estimator.noise.imu_gaps;
  const double t = to_seconds(newest_keyframe_ - *first_frame_);
  StartUncertainty sigma = config_.start;
  sigma.position_sigma_m = std::hypot(sigma.position_sigma_m, bounds.speed_sigma * t);
  sigma.yaw_sigma_rad = std::hypot(sigma.yaw_sigma_rad, bounds.turn_rate_sigma * t);
  sigma.tilt_sigma_rad = std::hypot(sigma.tilt_sigma_rad, bounds.turn_rate_sigma * t);
  return map_odom_estimate_at(T_map_body_first, T_odom_body, sigma);
}

// From the gyroscope alone; identity where the IMU has a gap.
Eigen::Quaterniond RobotPipeline::predicted_rotation(Timestamp stamp) const {
  if (!previous_frame_) return Eigen::Quaterniond::Identity();
  const std::vector<ImuSample> samples = imu_.between(*previous_frame_, stamp);
  if (samples.size() < 2) return Eigen::Quaterniond::Identity();
  const ImuBias bias = window_ ? window_->keyframes.back().state.bias : ImuBias{};
  return Preintegration(samples, bias, setup_.imu_noise).deltas(bias).R;
}

std::map<std::string, std::uint64_t> RobotPipeline::faults() const {
  std::map<std::string, std::uint64_t> faults = faults_;
  for (const auto& [reason, count] : input_validator_.refused()) {
    faults["refused_" + reason] = count;
  }
  return faults;
}

}  // namespace fleetloc
