#include "robot/fusion/delayed_frames.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <utility>

#include <Eigen/Cholesky>

#include "shared/geometry/covariance.hpp"

namespace fleetloc {
namespace {

DelayedFrames::Rank rank_of(const LocalizationResult& answer) {
  return {answer.revision, answer.incarnation, answer.localizer, answer.number};
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

DelayedFrames::DelayedFrames(const ImuNoise& noise, const PoseFusion::Config& config)
    : noise_(noise),
      buffer_(from_seconds(config.buffer_s)),
      drift_config_(config.drift),
      answer_noise_(config.answers.noise),
      drift_(config.drift) {}

void DelayedFrames::reset(SessionNumber session) {
  session_ = session;
  frames_.clear();
  newest_is_ahead_ = false;
  prediction_.reset();
  drift_ = OdometryDrift(drift_config_);
}

void DelayedFrames::forget_answers(SessionNumber session) {
  session_ = session;
  for (Frame& frame : frames_) {
    frame.newest.reset();
    frame.is_lost = false;
    frame.answer.reset();
  }
}

bool DelayedFrames::add_imu(const ImuSample& sample) {
  if (!imu_.add(sample)) {
    return false;
  }
  previous_imu_ = std::exchange(last_imu_, sample);
  imu_.forget_before(sample.stamp - buffer_);
  if (newest_is_ahead_) {
    predict_from_newest();
  }
  if (prediction_ && prediction_->stamp < sample.stamp) {
    advance(*prediction_, *previous_imu_, sample, noise_);
  }
  return true;
}

expected<void, FusionRejection> DelayedFrames::add_odometry(const OdometryEstimate& estimate) {
  if (!is_finite(estimate)) return unexpected(FusionRejection::kNotFinite);
  if (!frames_.empty() && estimate.stamp <= newest().odometry.stamp) {
    return unexpected(FusionRejection::kOlderThanApplied);
  }
  if (last_imu_ && estimate.stamp < last_imu_->stamp && !imu_.covers(estimate.stamp)) {
    return unexpected(FusionRejection::kBeforeImu);
  }
  Frame& frame = frames_.emplace_back();
  frame.odometry = estimate;
  frame.drift = drift_.step(estimate);
  predict_from_newest();
  return {};
}

// The prediction does not depend on when the frame arrived: it always starts at its stamp and
// takes one step per sample.
void DelayedFrames::predict_from_newest() {
  const OdometryEstimate& start = newest().odometry;
  newest_is_ahead_ = !last_imu_ || !imu_.covers(start.stamp);
  if (!newest_is_ahead_) {
    prediction_ = predict(start, imu_.between(start.stamp, last_imu_->stamp), noise_);
  }
}

bool DelayedFrames::has_stale() const {
  return !frames_.empty() && oldest().odometry.stamp < newest().odometry.stamp - buffer_;
}

std::optional<std::size_t> DelayedFrames::index_at(Timestamp stamp) const {
  const auto later = std::upper_bound(
      frames_.begin(), frames_.end(), stamp, [](Timestamp wanted, const Frame& frame) {
        return wanted < frame.odometry.stamp;
      });
  if (later == frames_.begin()) {
    return std::nullopt;
  }
  return static_cast<std::size_t>(std::distance(frames_.begin(), later)) - 1;
}

expected<void, FusionRejection> DelayedFrames::check(const LocalizationResult& answer) const {
  if (session_ && answer.session != *session_) return unexpected(FusionRejection::kWrongSession);
  if (answer.status != LocalizationStatus::kLocalized) {
    return unexpected(FusionRejection::kNotLocalized);
  }
  if (!is_finite(answer.T_map_body) || !answer.covariance.allFinite()) {
    return unexpected(FusionRejection::kNotFinite);
  }
  const bool symmetric = answer.covariance.isApprox(answer.covariance.transpose(), 1e-9);
  if (!symmetric || answer.covariance.llt().info() != Eigen::Success) {
    return unexpected(FusionRejection::kBadCovariance);
  }
  return {};
}

expected<std::size_t, FusionRejection> DelayedFrames::frame_of(Timestamp stamp) const {
  const std::optional<std::size_t> index = index_at(stamp);
  if (index && frames_[*index].odometry.stamp == stamp) return *index;
  const bool late = !frames_.empty() && stamp < newest().odometry.stamp - buffer_;
  return unexpected(late ? FusionRejection::kTooOld : FusionRejection::kUnknownStamp);
}

expected<std::size_t, FusionRejection> DelayedFrames::add_answer(const LocalizationResult& answer) {
  if (const auto usable = check(answer); !usable) return unexpected(usable.error());
  const auto index = frame_of(answer.stamp);
  if (!index) return index;
  Frame& frame = frames_[*index];
  const Rank rank = rank_of(answer);
  if (rank == frame.newest) return unexpected(FusionRejection::kDuplicate);
  if (rank < frame.newest) return unexpected(FusionRejection::kOlderThanApplied);
  frame.newest = rank;
  frame.answer = StoredMeasurement{
      .measurement = measurement_from(answer, frame.odometry.state.T_odom_body, answer_noise_),
      .outcome = std::nullopt};
  return index;
}

expected<std::size_t, FusionRejection> DelayedFrames::add_loss(const LocalizationResult& answer) {
  if (session_ && answer.session != *session_) return unexpected(FusionRejection::kWrongSession);
  const auto index = frame_of(answer.stamp);
  if (!index) return index;
  Frame& frame = frames_[*index];
  const Rank rank = rank_of(answer);
  if (rank < frame.newest) return unexpected(FusionRejection::kOlderThanApplied);
  frame.newest = rank;
  frame.is_lost = true;
  frame.answer.reset();
  return index;
}

PoseEstimate odom_estimate(const ImuPrediction& prediction) {
  PoseEstimate result;
  result.stamp = prediction.stamp;
  result.T_odom_body = prediction.state.T_odom_body;
  result.covariance_odom = pose_covariance(prediction);
  result.v_odom = prediction.state.v_odom;
  result.angular_velocity = prediction.angular_velocity;
  return result;
}

void set_pose_quality(PoseEstimate& estimate,
                      const MapPoseStatus& status,
                      const PoseFusion::Config& config) {
  estimate.quality = Quality::kLost;
  const double odometry_age_s = to_seconds(estimate.stamp - status.newest_odometry);
  if (!status.last_applied) {
    if (odometry_age_s <= config.odometry_timeout_s) estimate.quality = Quality::kSearching;
    return;
  }
  estimate.since_last_answer = std::max(Duration{}, estimate.stamp - *status.last_applied);
  const double sigma_rad = max_sigma(estimate.covariance_map.topLeftCorner<3, 3>());
  const double sigma_m = max_sigma(estimate.covariance_map.bottomRightCorner<3, 3>());
  if (status.contradicted || odometry_age_s > config.odometry_timeout_s ||
      sigma_rad > config.lost_beyond_rad || sigma_m > config.lost_beyond_m) {
    return;
  }
  const bool certain = sigma_rad < config.localized_below_rad && sigma_m < config.localized_below_m;
  const double aged_s = to_seconds(estimate.since_last_answer - status.standstill);
  const bool fresh = aged_s < config.localized_for_s;
  estimate.quality =
      certain && fresh && !status.carried ? Quality::kLocalized : Quality::kDeadReckoning;
}

}  // namespace fleetloc
