#include "robot/fusion/pose_fusion.hpp"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <tuple>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>

namespace fleetloc {
namespace {

Duration to_duration(double seconds) {
  return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds));
}

bool is_finite(const Pose& pose) {
  return pose.R.coeffs().allFinite() && pose.p.allFinite();
}

bool is_finite(const OdometryEstimate& estimate) {
  const NavState& state = estimate.state;
  return is_finite(state.T_odom_body) && state.v_odom.allFinite() &&
         state.bias.gyroscope.allFinite() && state.bias.accelerometer.allFinite() &&
         estimate.covariance.allFinite();
}

}  // namespace

PoseFusion::PoseFusion(const ImuNoise& noise, const Config& config)
    : noise_(noise),
      config_(config),
      drift_(config.drift),
      oldest_(config.answers),
      alignment_(config.answers) {}

void PoseFusion::reset(SessionNumber session, const std::optional<StartPose>& carried) {
  session_ = session;
  interrupted_ = false;
  frames_.clear();
  newest_frame_is_ahead_ = false;
  prediction_.reset();
  drift_ = OdometryDrift(config_.drift);
  oldest_ = carried ? alignment_.continued(*carried) : MapAlignment(config_.answers);
  alignment_ = oldest_;
}

PoseEstimate PoseFusion::add_imu(const ImuSample& sample) {
  if (imu_.add(sample)) {
    const std::optional<ImuSample> previous = std::exchange(last_imu_, sample);
    imu_.forget_before(sample.stamp - to_duration(config_.buffer_s));
    if (newest_frame_is_ahead_) {
      predict_from_newest_frame();
    }
    if (prediction_ && prediction_->stamp < sample.stamp) {
      advance(*prediction_, *previous, sample, noise_);
    }
  }
  if (prediction_) {
    return estimate(*prediction_);
  }
  PoseEstimate nothing;
  nothing.stamp = last_imu_ ? last_imu_->stamp : sample.stamp;
  return nothing;
}

PoseFusion::Verdict PoseFusion::add_odometry(const OdometryEstimate& estimate) {
  if (!is_finite(estimate)) {
    return {.applied = false, .reason = "not_finite"};
  }
  if (!frames_.empty() && estimate.stamp <= frames_.back().odometry.stamp) {
    return {.applied = false, .reason = "older_than_applied"};
  }
  if (last_imu_ && estimate.stamp < last_imu_->stamp && !imu_.covers(estimate.stamp)) {
    return {.applied = false, .reason = "before_imu"};
  }
  frames_.push_back({.odometry = estimate, .drift = drift_.step(estimate), .answer = std::nullopt});
  alignment_.drift(frames_.back().drift);
  forget_old_frames();
  predict_from_newest_frame();
  return {.applied = true, .reason = "applied"};
}

// The prediction does not depend on when the frame arrived: it always starts at its stamp and
// takes one step per sample.
void PoseFusion::predict_from_newest_frame() {
  const OdometryEstimate& start = frames_.back().odometry;
  newest_frame_is_ahead_ = !last_imu_ || !imu_.covers(start.stamp);
  if (!newest_frame_is_ahead_) {
    prediction_ = predict(start, imu_.between(start.stamp, last_imu_->stamp), noise_);
  }
}

// What leaves the buffer has its final effect on the filter that replays start from.
void PoseFusion::forget_old_frames() {
  const Timestamp horizon = frames_.back().odometry.stamp - to_duration(config_.buffer_s);
  while (frames_.front().odometry.stamp < horizon) {
    const Frame& frame = frames_.front();
    oldest_.drift(frame.drift);
    if (frame.answer) {
      oldest_.apply(frame.answer->measurement);
    }
    frames_.pop_front();
  }
}

std::string_view PoseFusion::why_unusable(const Answer& answer) const {
  if (session_ && answer.session != *session_) {
    return "wrong_session";
  }
  if (answer.status != LocalizationStatus::kLocalized) {
    return "not_localized";
  }
  if (!is_finite(answer.T_map_body) || !answer.covariance.allFinite()) {
    return "not_finite";
  }
  const bool symmetric = answer.covariance.isApprox(answer.covariance.transpose(), 1e-9);
  if (!symmetric || answer.covariance.llt().info() != Eigen::Success) {
    return "bad_covariance";
  }
  return {};
}

std::string_view PoseFusion::why_no_frame(Timestamp stamp) const {
  const bool late =
      !frames_.empty() && stamp < frames_.back().odometry.stamp - to_duration(config_.buffer_s);
  return late ? "too_old" : "unknown_stamp";
}

PoseFusion::Verdict PoseFusion::add_answer(const Answer& answer) {
  if (const std::string_view reason = why_unusable(answer); !reason.empty()) {
    return {.applied = false, .reason = reason};
  }
  const auto frame = std::lower_bound(
      frames_.begin(), frames_.end(), answer.stamp, [](const Frame& candidate, Timestamp stamp) {
        return candidate.odometry.stamp < stamp;
      });
  if (frame == frames_.end() || frame->odometry.stamp != answer.stamp) {
    return {.applied = false, .reason = why_no_frame(answer.stamp)};
  }
  if (frame->answer) {
    // A total order, so that one of several answers to a frame wins whichever comes first.
    const AnswerMeasurement& known = frame->answer->measurement;
    const auto rank = std::tie(answer.revision, answer.epoch, answer.localizer);
    const auto known_rank = std::tie(frame->answer->revision, known.epoch, known.localizer);
    if (rank <= known_rank) {
      return {.applied = false, .reason = rank == known_rank ? "duplicate" : "older_than_applied"};
    }
  }
  frame->answer =
      StoredAnswer{.revision = answer.revision,
                   .measurement = measurement_from(
                       answer, frame->odometry.state.T_odom_body, config_.answers.noise),
                   .outcome = std::nullopt};
  const int revised = replay_answers();
  const AnswerOutcome outcome = *frame->answer->outcome;
  return {.applied = is_applied(outcome), .reason = name(outcome), .revised = revised};
}

int PoseFusion::replay_answers() {
  int revised = 0;
  alignment_ = oldest_;
  for (Frame& frame : frames_) {
    alignment_.drift(frame.drift);
    if (frame.answer) {
      const AnswerOutcome outcome = alignment_.apply(frame.answer->measurement);
      const std::optional<AnswerOutcome> before = std::exchange(frame.answer->outcome, outcome);
      revised += before && is_applied(*before) != is_applied(outcome) ? 1 : 0;
    }
  }
  return revised;
}

std::optional<PoseEstimate> PoseFusion::estimate_at(Timestamp stamp) const {
  const auto later = std::upper_bound(
      frames_.begin(), frames_.end(), stamp, [](Timestamp wanted, const Frame& frame) {
        return wanted < frame.odometry.stamp;
      });
  if (later == frames_.begin()) {
    return std::nullopt;
  }
  const OdometryEstimate& start = std::prev(later)->odometry;
  const std::vector<ImuSample> samples = imu_.between(start.stamp, stamp);
  if (samples.empty()) {
    return std::nullopt;
  }
  return estimate(predict(start, samples, noise_));
}

PoseEstimate PoseFusion::estimate(const ImuPrediction& prediction) const {
  PoseEstimate result;
  result.stamp = prediction.stamp;
  result.quality = quality_at(prediction.stamp);
  result.T_odom_body = prediction.state.T_odom_body;
  result.covariance_odom = pose_covariance(prediction);
  result.v_odom = prediction.state.v_odom;
  result.angular_velocity = prediction.angular_velocity;
  if (const std::optional<StartPose> alignment = alignment_.pose()) {
    result.since_last_answer = std::max(Duration{}, result.stamp - *alignment_.last_applied());
    result.T_map_body = alignment->T_map_odom * result.T_odom_body;
    result.covariance_map = map_covariance(*alignment, prediction);
  }
  return result;
}

Matrix6d PoseFusion::map_covariance(const StartPose& alignment,
                                    const ImuPrediction& prediction) const {
  const Matrix6d A = adjoint(inverse(prediction.state.T_odom_body));
  return A * alignment.covariance * A.transpose() + clone_covariance(config_.answers.noise) +
         pose_covariance_since_start(prediction);
}

Quality PoseFusion::quality_at(Timestamp stamp) const {
  const std::optional<Timestamp> last_applied = alignment_.last_applied();
  const double odometry_age_s = to_seconds(stamp - frames_.back().odometry.stamp);
  if (!last_applied || alignment_.contradicted() || odometry_age_s > config_.odometry_timeout_s) {
    return Quality::kLost;
  }
  const bool fresh = !interrupted_ && !alignment_.is_continued() &&
                     to_seconds(stamp - *last_applied) < config_.localized_for_s;
  return fresh ? Quality::kLocalized : Quality::kDeadReckoning;
}

std::optional<StartPose> PoseFusion::start_pose() const {
  return alignment_.pose();
}

PoseFusion::Config read_pose_fusion_config(ConfigReader section) {
  PoseFusion::Config config;
  config.buffer_s = section.positive("buffer_s");
  config.localized_for_s = section.positive("localized_for_s");
  config.odometry_timeout_s = section.positive("odometry_timeout_s");
  config.drift = read_odometry_drift_config(section.section("drift"));
  config.answers = read_map_alignment_config(section.section("answers"));
  return config;
}

}  // namespace fleetloc
