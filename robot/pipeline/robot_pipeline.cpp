#include "robot/pipeline/robot_pipeline.hpp"

#include <algorithm>
#include <utility>
#include <variant>

namespace fleetloc {

RobotPipeline::RobotPipeline(RobotSetup setup,
                             const Config& config,
                             BackEnd& back_end,
                             MapLocalizer* localizer,
                             CpuClock cpu_clock)
    : setup_(std::move(setup)),
      localizer_(localizer),
      cpu_clock_(std::move(cpu_clock)),
      max_imu_step_(max_imu_step(config.odometry)),
      input_validator_(max_imu_step_),
      odometry_(setup_.calibration, setup_.imu_noise, config.odometry, back_end, cpu_clock_),
      fusion_(make_pose_fusion(inflated(setup_.imu_noise, config.odometry.frame_estimator.noise),
                               config.fusion)),
      session_start_(
          setup_.T_map_body, config.start, config.odometry.frame_estimator.noise.imu_gaps),
      region_(setup_.region) {}

expected<PoseEstimate, InputRejection> RobotPipeline::add_imu(const ImuSample& sample) {
  ImuSample timed = sample;
  timed.stamp = time_.time_of(sample.stamp);
  const auto accepted = input_validator_.check_imu(timed);
  if (!accepted) return unexpected(accepted.error());
  for (const ImuSample& one : *accepted) predict(one);
  track_frames();
  return with_stamp(latest_pose_);
}

expected<void, InputRejection> RobotPipeline::add_frame(CameraFrame frame) {
  std::visit([this](auto& any) { any.stamp = time_.time_of(any.stamp); }, frame);
  const auto accepted = input_validator_.check_frame(stamp_of(frame));
  if (!accepted) return accepted;
  odometry_.add_frame(std::move(frame));
  track_frames();
  return {};
}

// How far the clock was set is known no better than samples arrive, so nothing may be integrated
// across: a gap that is just too long for it lets the odometry be reset by its own rule.
void RobotPipeline::step_clock(const ClockStep& step) {
  constexpr Duration kBeyond = std::chrono::milliseconds(1);
  ++faults_["clock_steps"];
  if (!last_imu_) return;
  time_.step(step.stamp, *last_imu_ + std::max(step.unseen, max_imu_step_ + kBeyond));
}

// In the cloud's eyes a robot that is placed is another one, with the same keyframes. A stamp that
// is not of the robot's latest seconds is of another clock: it is placed where it is now.
void RobotPipeline::place(const GivenPose& given) {
  ++faults_["placements"];
  region_.reset();
  if (latest_pose_.quality == Quality::kInitializing) {
    return session_start_.place_before_odometry(given);
  }
  const Timestamp stamp = time_.time_of(given.stamp);
  const bool is_past = stamp <= latest_pose_.stamp;
  const auto then = is_past ? fusion_->estimate_at(stamp) : std::nullopt;
  const auto start = session_start_.place(given, then.value_or(latest_pose_).T_odom_body);
  ++placements_;
  fusion_->forget_map(session());
  odometry_.forget_corrections();
  const bool is_tracking = odometry_.phase() == VisualInertialOdometry::Phase::kTracking;
  if (localizer_ == nullptr || !is_tracking) return;  // or with the next odometry
  localizer_->restart_session(announced(start), *last_imu_);
}

void RobotPipeline::poll(Timestamp stamp) {
  const Timestamp now = time_.time_of(stamp);
  odometry_.set_place_known(localizer_ == nullptr || latest_pose_.quality == Quality::kLocalized);
  if (localizer_ != nullptr) localizer_->update(now, latest_pose_.quality);
  take_window(now);
  if (localizer_ != nullptr) fuse_answers(now);
}

void RobotPipeline::predict(const ImuSample& sample) {
  ++imu_samples_;
  last_imu_ = sample.stamp;
  if (!odometry_.add_imu(sample)) fusion_->interrupt();
  const Duration begin = cpu_clock_ ? cpu_clock_() : Duration{};
  latest_pose_ = fusion_->add_imu(sample);
  if (cpu_clock_) fusion_cpu_ += cpu_clock_() - begin;
}

void RobotPipeline::track_frames() {
  while (const auto frame = odometry_.track_next()) {
    FrameOutput output = fuse(*frame);
    output.stamp = time_.stamp_of(output.stamp);
    output.pose = with_stamp(std::move(output.pose));
    frames_.push_back(std::move(output));
  }
}

FrameOutput RobotPipeline::fuse(const OdometryFrame& frame) {
  if (frame.reset) fusion_->interrupt();
  if (frame.estimate) fuse(*frame.estimate);
  FrameOutput output{.stamp = frame.stamp,
                     .pose = pose_at(frame.stamp),
                     .tracks = frame.tracks,
                     .keyframe = frame.keyframe,
                     .resets = odometry_.statistics().resets,
                     .tracking_cpu = frame.cpu};
  if (!frame.in_imu_gap) {
    session_start_.note_frame(frame.stamp);
    odometry_.add_dead_reckoned(output.pose);
  }
  return output;
}

void RobotPipeline::fuse(const OdometryEstimate& estimate) {
  const auto added = fusion_->add_odometry(estimate);
  if (!added) ++faults_["unfused_" + std::string(name(added.error()))];
}

// Outside of fusion's buffer the pose at the newest IMU sample, the first one after the frame.
PoseEstimate RobotPipeline::pose_at(Timestamp stamp) const {
  PoseEstimate pose = fusion_->estimate_at(stamp).value_or(latest_pose_);
  pose.stamp = stamp;
  return pose;
}

PoseEstimate RobotPipeline::with_stamp(PoseEstimate pose) const {
  pose.stamp = time_.stamp_of(pose.stamp);
  return pose;
}

void RobotPipeline::take_window(Timestamp now) {
  auto taken = odometry_.take_window(now);
  if (!taken) return fusion_->interrupt();
  if (!taken->has_value()) return;
  OdometryWindow& window = **taken;
  if (window.start) begin_odometry(window);
  if (localizer_ == nullptr) return;
  if (window.start) begin_session(window, now);
  const Pose& T_odom_body = window.window->keyframes.back().state.T_odom_body;
  if (const auto start = start_from_answers(T_odom_body)) {
    region_.reset();
    localizer_->update_start(*start);
  }
  localizer_->submit(std::move(window.submap), now);
}

// The cloud may answer for the first window's newest keyframe, so fusion needs its odometry.
void RobotPipeline::begin_odometry(const OdometryWindow& window) {
  std::optional<MapOdomEstimate> carried;
  const std::optional<PoseEstimate>& continued = window.start->continued;
  if (continued && continued->T_map_body) {
    carried = continued_alignment(*continued, window.window->keyframes.front().state.T_odom_body);
  }
  fusion_->reset(session(), carried);
  const WindowKeyframe& newest = window.window->keyframes.back();
  fuse({newest.stamp, newest.state, window.window->covariance});
}

void RobotPipeline::begin_session(const OdometryWindow& window, Timestamp now) {
  const Pose& T_odom_body = window.window->keyframes.back().state.T_odom_body;
  const auto start =
      session_start_.of_session(*window.start, T_odom_body, start_from_answers(T_odom_body));
  if (!start) ++faults_[std::string(name(start.error()))];
  keep_region(*window.start);
  if (!start && start.error() == NoStart::kTooUncertain) fusion_->lose();
  localizer_->start_session(announced(start ? std::optional(*start) : std::nullopt), now);
}

// Its place in odom is that of the first frame of all. A robot that has moved unseen since then may
// have left it.
void RobotPipeline::keep_region(const OdometryStart& begin) {
  if (!region_) return;
  if (!begin.T_first_newest) {
    ++faults_["forgotten_regions"];
    return region_.reset();
  }
  region_->p_odom = (begin.T_odom_body * inverse(*begin.T_first_newest)).p;
}

RobotSession RobotPipeline::announced(const std::optional<MapOdomEstimate>& start) const {
  RobotSession announced;
  announced.robot = setup_.id;
  announced.session = session();
  announced.start_stamp = setup_.program_start;
  announced.stereo = rectified(setup_.calibration);
  announced.start = start;
  if (!start) announced.region = region_;
  return announced;
}

// A correction comes with the answer to its anchor, and is worth what that is.
void RobotPipeline::fuse_answers(Timestamp now) {
  std::vector<LocalizationResult> answers = localizer_->take_answers(now);
  std::optional<Correction> correction = localizer_->take_correction();
  for (LocalizationResult& answer : answers) {
    const std::optional<Vector6d> innovation = innovation_of(answer);
    const AnswerOutcome outcome = fusion_->add_answer(answer);
    if (outcome) localizer_->note_applied();
    const bool is_gated = outcome == unexpected(FusionRejection::kGated);
    const bool is_lost = answer.status == LocalizationStatus::kLost;
    const bool is_elsewhere = outcome && *outcome == AnswerEffect::kRestarted;
    if (is_lost || is_elsewhere) odometry_.forget_corrections();
    const bool is_its_own = correction && correction->anchor == answer.keyframe;
    const bool is_older = correction && correction->anchor < answer.keyframe;
    if ((is_its_own && (is_gated || is_lost)) || (is_older && (is_lost || is_elsewhere))) {
      correction.reset();
    }
    answer.stamp = time_.stamp_of(answer.stamp);
    answer.oldest_stamp = time_.stamp_of(answer.oldest_stamp);
    answers_.push_back({.answer = std::move(answer),
                        .arrival = time_.stamp_of(now),
                        .outcome = outcome,
                        .innovation = innovation});
  }
  if (correction) odometry_.add_correction(*std::move(correction));
}

std::optional<Vector6d> RobotPipeline::innovation_of(const LocalizationResult& answer) const {
  if (answer.status != LocalizationStatus::kLocalized) return std::nullopt;
  const auto before = fusion_->estimate_at(answer.stamp);
  if (!before || !before->T_map_body) return std::nullopt;
  return local_coordinates(*before->T_map_body, answer.T_map_body);
}

// Nothing before the first applied answer, or if it is older than a gap in the IMU's data.
std::optional<MapOdomEstimate> RobotPipeline::start_from_answers(const Pose& T_odom_body) const {
  auto start = fusion_->session_start();
  if (start) start->p_odom = T_odom_body.p;
  return start;
}

LinkTraffic RobotPipeline::traffic() const {
  return localizer_ != nullptr ? localizer_->traffic() : LinkTraffic{};
}

SessionNumber RobotPipeline::session() const {
  return SessionNumber{static_cast<std::uint32_t>(setup_.session) +
                       static_cast<std::uint32_t>(odometry_.statistics().resets) + placements_};
}

std::map<std::string, std::uint64_t> RobotPipeline::faults() const {
  std::map<std::string, std::uint64_t> faults = odometry_.faults();
  for (const auto& [kind, count] : faults_) faults[kind] = count;
  for (const auto& [reason, count] : input_validator_.rejected()) {
    faults["refused_" + reason] = count;
  }
  return faults;
}

}  // namespace fleetloc
