#pragma once

#include <optional>

#include "robot/fusion/alignment_hypotheses.hpp"
#include "robot/fusion/answer_outcome.hpp"
#include "robot/fusion/localization_measurement.hpp"
#include "robot/fusion/odometry_drift.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/model/session.hpp"

namespace fleetloc {

/// Kalman filter over T_map_odom and the slowly varying error of the answers. State:
/// [d: right perturbation of T_map_odom (6), u: normalized error of the answers (6)]; see
/// LocalizationMeasurement. Feed drift and answers in order of their stamps. A value: copy it to
/// replay.
class MapAlignment {
 public:
  struct Config {
    /// Of u: answers share the errors of their common keyframes, and those of the map along the
    /// way; whichever is more counts.
    double correlation_distance_m = 0.0;
    double same_view_m = 0.0;           ///< answers from within this see the same
    double gate_chi_square = 0.0;       ///< of an answer, 6 degrees of freedom
    double map_tilt = 0.0;              ///< sigma of roll and pitch of T_map_odom [rad]
    double tilt_gate_chi_square = 0.0;  ///< 2 degrees of freedom
    LocalizationNoise noise;
    AlignmentHypotheses::Config hypotheses;
  };
  explicit MapAlignment(const Config& config);

  /// T_map_odom becomes more uncertain (right perturbation), the mean stays.
  void drift(const DriftStep& step);

  AnswerOutcome apply(const LocalizationMeasurement& answer);

  /// The localizer has said that T_map_odom is wrong.
  void lose() { hypotheses_.lose(); }

  /// T_map_odom with covariance, from the first applied answer on.
  [[nodiscard]] std::optional<MapOdomEstimate> pose() const;
  /// The same, with a covariance inflated to cover contradicting hypotheses.
  [[nodiscard]] std::optional<MapOdomEstimate> session_start() const;
  [[nodiscard]] std::optional<Timestamp> last_applied() const { return last_applied_; }
  /// How long the robot has stood still since.
  [[nodiscard]] Duration standstill() const { return standstill_; }
  /// The filter after a reset of the odometry: `pose` is its T_map_odom until the first answer that
  /// agrees with it initializes it again. Its covariance is that of yaw and position: the tilt is
  /// that of the map against gravity, which the new odometry knows. Empty if no answer was applied
  /// before.
  [[nodiscard]] MapAlignment continued(const MapOdomEstimate& pose) const;
  /// No answer has been applied since.
  [[nodiscard]] bool is_continued() const { return continued_; }

  /// Rejected answers agree with each other on another T_map_odom, or see lose().
  [[nodiscard]] bool contradicted() const { return hypotheses_.contradict(); }

 private:
  using Matrix12d = Eigen::Matrix<double, 12, 12>;

  AnswerOutcome initialize(const LocalizationMeasurement& answer, AnswerEffect effect);
  AnswerOutcome apply_to_continued(const LocalizationMeasurement& answer);
  [[nodiscard]] bool agrees_with_continued(const LocalizationMeasurement& answer) const;
  void transform_error(const Matrix6d& F);
  void normalize_error(const Matrix6d& error, const Matrix6d& root);
  void carry_error_to(const Eigen::Vector3d& p_map_body);
  void widen_error(const LocalizationMeasurement& answer);
  [[nodiscard]] double shared_window(const LocalizationMeasurement& answer) const;
  [[nodiscard]] Matrix6d error_transition(const LocalizationMeasurement& answer) const;
  void age_error(const LocalizationMeasurement& answer);
  template <int N>
  void update(const Eigen::Matrix<double, N, 1>& residual,
              const Eigen::Matrix<double, N, 12>& H,
              const Eigen::Matrix<double, N, N>& R);

  Config config_;
  MapHash map_hash_{};
  bool continued_ = false;
  std::optional<Timestamp> last_applied_;
  Duration standstill_{};         ///< since last_applied_
  Timestamp error_stamp_;         ///< of the answer that u belongs to
  Timestamp error_oldest_stamp_;  ///< where the window of that answer begins
  Eigen::Vector3d error_p_map_body_ = Eigen::Vector3d::Zero();  ///< of that answer
  Matrix6d error_root_ = Matrix6d::Identity();  ///< of its covariance at the body, in map axes
  double metres_since_error_ = 0.0;
  Pose T_map_odom_;
  Vector6d error_ = Vector6d::Zero();  ///< u
  Matrix12d P_ = Matrix12d::Zero();
  AlignmentHypotheses hypotheses_;
};

MapAlignment::Config read_map_alignment_config(ConfigReader section);

}  // namespace fleetloc
