#pragma once

#include <optional>

#include "robot/fusion/alignment_hypotheses.hpp"
#include "robot/fusion/map_alignment.hpp"
#include "robot/inertial/preintegration.hpp"
#include "shared/model/inertial.hpp"

namespace fleetloc {

/// The paper's filter: error-state EKF in map, after Lynen et al. (2013). State: T_map_body,
/// velocity and biases (NavState's tangent, 15), and T_map_odom (right perturbation, 6), which
/// absorbs the drift of the odometry. The odometry measures T_map_odom^-1 * T_map_body, an answer
/// T_map_body; all errors are taken as white, and gravity as the map's -z. Errors that are
/// correlated in time, as those of answers with overlapping windows, therefore make it
/// overconfident.
///
/// Feed steps and measurements in order of their stamps. A value: copy it to replay.
class MapBodyFilter {
 public:
  explicit MapBodyFilter(const MapAlignment::Config& config);

  /// Inertial prediction from one frame to the next, and drift of T_map_odom over it.
  void propagate(const Preintegration& step, const DriftStep& drift);

  /// The odometry's pose at the frame.
  void correct(const Pose& T_odom_body);

  /// The answer to the frame. The first one starts the filter at the odometry's state.
  AnswerOutcome apply(const LocalizationMeasurement& answer, const OdometryEstimate& odometry);

  /// The localizer has said that the pose is wrong.
  void lose() { hypotheses_.lose(); }

  /// In map where its members say odom; valid from the first applied answer on.
  [[nodiscard]] const NavState& state() const { return state_; }
  [[nodiscard]] Matrix15d covariance() const { return P_.topLeftCorner<15, 15>(); }
  [[nodiscard]] std::optional<MapOdomEstimate> session_start() const;
  [[nodiscard]] std::optional<Timestamp> last_applied() const { return last_applied_; }
  [[nodiscard]] bool contradicted() const { return hypotheses_.contradict(); }

 private:
  using Matrix21d = Eigen::Matrix<double, 21, 21>;
  using Matrix6x21d = Eigen::Matrix<double, 6, 21>;

  AnswerOutcome initialize(const LocalizationMeasurement& answer,
                           const OdometryEstimate& odometry,
                           AnswerEffect effect);
  void update(const Vector6d& residual, const Matrix6x21d& H, const Matrix6d& R);

  MapAlignment::Config config_;
  MapHash map_hash_{};
  std::optional<Timestamp> last_applied_;
  NavState state_;
  Pose T_map_odom_;
  Matrix21d P_ = Matrix21d::Zero();
  AlignmentHypotheses hypotheses_;
};

}  // namespace fleetloc
