#pragma once

#include <optional>

#include "robot/fusion/delayed_frames.hpp"
#include "robot/fusion/imu_prediction.hpp"
#include "robot/fusion/map_alignment.hpp"
#include "robot/fusion/pose_fusion.hpp"

namespace fleetloc {

/// The default. Two blocks:
///
/// - odom: inertial prediction from the odometry's last state.
/// - map: T_map_odom (MapAlignment). An answer is a measurement of it at the answer's own stamp,
///   against the odometry's estimate of that frame.
///
/// Approximations: the covariance of T_map_body is that of T_map_odom at the newest frame, moved to
/// the body, plus the noise of one frame, plus the inertial prediction since that frame; these
/// three are taken as independent. Frames keep the odometry's causal estimate: a later revision of
/// a keyframe is not used. T_map_odom is linearized about the estimate (EKF, not iterated).
class DecoupledFusion final : public PoseFusion {
 public:
  DecoupledFusion(const ImuNoise& noise, const Config& config);

  PoseEstimate add_imu(const ImuSample& sample) override;
  expected<void, FusionRejection> add_odometry(const OdometryEstimate& estimate) override;
  AnswerOutcome add_answer(const LocalizationResult& answer) override;
  [[nodiscard]] std::optional<PoseEstimate> estimate_at(Timestamp stamp) const override;
  void lose() override;
  void interrupt() override { interrupted_ = true; }
  void reset(SessionNumber session, const std::optional<MapOdomEstimate>& carried) override;
  void forget_map(SessionNumber session) override;
  [[nodiscard]] std::optional<MapOdomEstimate> session_start() const override;

 private:
  [[nodiscard]] PoseEstimate estimate(const ImuPrediction& prediction) const;
  [[nodiscard]] Matrix6d map_covariance(const MapOdomEstimate& alignment,
                                        const ImuPrediction& prediction) const;
  void forget_old_frames();
  void replay_answers();

  Config config_;
  DelayedFrames frames_;
  bool interrupted_ = false;
  MapAlignment oldest_;     ///< just before the oldest frame
  MapAlignment alignment_;  ///< at the newest frame
};

}  // namespace fleetloc
