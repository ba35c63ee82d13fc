#include "robot/fusion/decoupled_fusion.hpp"

#include <utility>
#include <vector>

namespace fleetloc {

DecoupledFusion::DecoupledFusion(const ImuNoise& noise, const Config& config)
    : config_(config),
      frames_(noise, config),
      oldest_(config.answers),
      alignment_(config.answers) {}

void DecoupledFusion::reset(SessionNumber session, const std::optional<MapOdomEstimate>& carried) {
  frames_.reset(session);
  interrupted_ = false;
  oldest_ = carried ? alignment_.continued(*carried) : MapAlignment(config_.answers);
  alignment_ = oldest_;
}

void DecoupledFusion::forget_map(SessionNumber session) {
  frames_.forget_answers(session);
  oldest_ = MapAlignment(config_.answers);
  alignment_ = oldest_;
}

PoseEstimate DecoupledFusion::add_imu(const ImuSample& sample) {
  frames_.add_imu(sample);
  if (frames_.prediction()) {
    return estimate(*frames_.prediction());
  }
  PoseEstimate nothing;
  nothing.stamp = frames_.last_imu() ? frames_.last_imu()->stamp : sample.stamp;
  return nothing;
}

expected<void, FusionRejection> DecoupledFusion::add_odometry(const OdometryEstimate& estimate) {
  if (const auto added = frames_.add_odometry(estimate); !added) return added;
  alignment_.drift(frames_.newest().drift);
  forget_old_frames();
  return {};
}

// Frames that leave the buffer are applied for good to the filter from which replays start.
void DecoupledFusion::forget_old_frames() {
  while (frames_.has_stale()) {
    const DelayedFrames::Frame& frame = frames_.oldest();
    oldest_.drift(frame.drift);
    if (frame.is_lost) oldest_.lose();
    if (frame.answer) {
      oldest_.apply(frame.answer->measurement);
    }
    frames_.forget_oldest();
  }
}

void DecoupledFusion::lose() {
  if (frames_.empty()) return;
  frames_.lose();
  replay_answers();
}

AnswerOutcome DecoupledFusion::add_answer(const LocalizationResult& answer) {
  if (answer.status == LocalizationStatus::kLost && frames_.add_loss(answer)) replay_answers();
  const auto frame = frames_.add_answer(answer);
  if (!frame) return unexpected(frame.error());
  replay_answers();
  return *frames_[*frame].answer->outcome;
}

void DecoupledFusion::replay_answers() {
  alignment_ = oldest_;
  for (DelayedFrames::Frame& frame : frames_) {
    alignment_.drift(frame.drift);
    if (frame.is_lost) alignment_.lose();
    if (frame.answer) frame.answer->outcome = alignment_.apply(frame.answer->measurement);
  }
}

std::optional<PoseEstimate> DecoupledFusion::estimate_at(Timestamp stamp) const {
  const std::optional<std::size_t> index = frames_.index_at(stamp);
  if (!index) {
    return std::nullopt;
  }
  const OdometryEstimate& start = frames_[*index].odometry;
  const std::vector<ImuSample> samples = frames_.imu().between(start.stamp, stamp);
  if (samples.empty()) {
    return std::nullopt;
  }
  return estimate(predict(start, samples, frames_.noise()));
}

PoseEstimate DecoupledFusion::estimate(const ImuPrediction& prediction) const {
  PoseEstimate result = odom_estimate(prediction);
  if (const std::optional<MapOdomEstimate> alignment = alignment_.pose()) {
    result.T_map_body = alignment->T_map_odom * result.T_odom_body;
    result.covariance_map = map_covariance(*alignment, prediction);
  }
  set_pose_quality(result,
                   {.last_applied = alignment_.last_applied(),
                    .standstill = alignment_.standstill(),
                    .contradicted = alignment_.contradicted(),
                    .carried = interrupted_ || alignment_.is_continued(),
                    .newest_odometry = frames_.newest().odometry.stamp},
                   config_);
  return result;
}

Matrix6d DecoupledFusion::map_covariance(const MapOdomEstimate& alignment,
                                         const ImuPrediction& prediction) const {
  const Matrix6d A = adjoint(inverse(prediction.state.T_odom_body));
  return A * alignment.covariance * A.transpose() + clone_covariance(config_.answers.noise) +
         pose_covariance_since_start(prediction);
}

std::optional<MapOdomEstimate> DecoupledFusion::session_start() const {
  return alignment_.session_start();
}

}  // namespace fleetloc
