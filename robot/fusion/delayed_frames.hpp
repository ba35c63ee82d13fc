#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <tuple>

#include "robot/fusion/answer_outcome.hpp"
#include "robot/fusion/imu_prediction.hpp"
#include "robot/fusion/localization_measurement.hpp"
#include "robot/fusion/map_alignment.hpp"
#include "robot/fusion/odometry_drift.hpp"
#include "robot/fusion/pose_fusion.hpp"
#include "robot/inertial/imu_buffer.hpp"

namespace fleetloc {

/// The buffer of a delayed-state filter, for replay: IMU samples, frames of the odometry and their
/// answers of the last seconds. Validates each measurement. Its inertial prediction from the newest
/// frame is the odom pose.
class DelayedFrames {
 public:
  /// Of an answer. A total order: which one of several to a frame counts does not depend on their
  /// arrival.
  using Rank = std::tuple<Revision, Incarnation, std::string, std::uint32_t>;
  struct StoredMeasurement {
    LocalizationMeasurement measurement;
    std::optional<AnswerOutcome> outcome;  ///< none before the first replay
  };
  struct Frame {
    OdometryEstimate odometry;
    DriftStep drift;             ///< since the frame before
    std::optional<Rank> newest;  ///< of the answers to it
    bool is_lost = false;        ///< so it was said; `answer` is newer
    std::optional<StoredMeasurement> answer;
  };

  DelayedFrames(const ImuNoise& noise, const PoseFusion::Config& config);

  /// After a reset of the odometry.
  void reset(SessionNumber session);
  /// After it only answers to this session are stored.
  void forget_answers(SessionNumber session);

  /// False if the sample changes nothing.
  bool add_imu(const ImuSample& sample);

  /// Appends a frame. Removes none.
  expected<void, FusionRejection> add_odometry(const OdometryEstimate& estimate);

  /// Checks an answer whatever its stamp is.
  [[nodiscard]] expected<void, FusionRejection> check(const LocalizationResult& answer) const;

  /// Stores the answer at its frame.
  /// @return the index of the frame
  expected<std::size_t, FusionRejection> add_answer(const LocalizationResult& answer);

  /// Notes that the answer, of status kLost, takes back where the robot was until its frame.
  /// @return the index of the frame
  expected<std::size_t, FusionRejection> add_loss(const LocalizationResult& answer);
  /// Notes the same of the newest frame; there must be one.
  void lose() { frames_.back().is_lost = true; }

  /// The oldest frame is older than the buffer.
  [[nodiscard]] bool has_stale() const;
  void forget_oldest() { frames_.pop_front(); }

  [[nodiscard]] bool empty() const { return frames_.empty(); }
  [[nodiscard]] std::size_t size() const { return frames_.size(); }
  [[nodiscard]] Frame& operator[](std::size_t index) { return frames_[index]; }
  [[nodiscard]] const Frame& operator[](std::size_t index) const { return frames_[index]; }
  [[nodiscard]] const Frame& oldest() const { return frames_.front(); }
  [[nodiscard]] const Frame& newest() const { return frames_.back(); }
  [[nodiscard]] auto begin() { return frames_.begin(); }
  [[nodiscard]] auto end() { return frames_.end(); }

  /// The newest frame at or before the stamp.
  [[nodiscard]] std::optional<std::size_t> index_at(Timestamp stamp) const;

  [[nodiscard]] const ImuBuffer& imu() const { return imu_; }
  [[nodiscard]] const ImuNoise& noise() const { return noise_; }
  [[nodiscard]] const std::optional<ImuSample>& last_imu() const { return last_imu_; }
  [[nodiscard]] const std::optional<ImuSample>& previous_imu() const { return previous_imu_; }

  /// The newest frame is ahead of the IMU: the prediction starts at the one before.
  [[nodiscard]] bool newest_is_ahead() const { return newest_is_ahead_; }
  /// In odom at the last IMU sample.
  [[nodiscard]] const std::optional<ImuPrediction>& prediction() const { return prediction_; }

 private:
  [[nodiscard]] expected<std::size_t, FusionRejection> frame_of(Timestamp stamp) const;
  void predict_from_newest();

  ImuNoise noise_;
  Duration buffer_;
  OdometryDrift::Config drift_config_;
  LocalizationNoise answer_noise_;
  std::optional<SessionNumber> session_;
  ImuBuffer imu_;
  std::optional<ImuSample> last_imu_;
  std::optional<ImuSample> previous_imu_;
  std::deque<Frame> frames_;  ///< oldest first
  bool newest_is_ahead_ = false;
  std::optional<ImuPrediction> prediction_;
  OdometryDrift drift_;
};

/// What determines the quality of a map pose.
struct MapPoseStatus {
  std::optional<Timestamp> last_applied;  ///< stamp of the last applied answer
  Duration standstill{};                  ///< since then: it makes no pose worse
  bool contradicted = false;
  bool carried = false;  ///< over a failure of the odometry, not confirmed since
  Timestamp newest_odometry;
};

/// The odom pose of a prediction, without a map pose.
PoseEstimate odom_estimate(const ImuPrediction& prediction);

/// Sets the quality and the age of the last answer; needs the covariance of the map pose.
void set_pose_quality(PoseEstimate& estimate,
                      const MapPoseStatus& status,
                      const PoseFusion::Config& config);

}  // namespace fleetloc
