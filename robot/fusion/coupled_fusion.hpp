#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "robot/fusion/delayed_frames.hpp"
#include "robot/fusion/imu_prediction.hpp"
#include "robot/fusion/map_body_filter.hpp"
#include "robot/fusion/pose_fusion.hpp"
#include "robot/inertial/preintegration.hpp"

namespace fleetloc {

/// Paper mode: one filter in map (MapBodyFilter), updated at the frames of the odometry; the map
/// pose is an inertial prediction from its newest state. The state at each frame is stored, so that
/// a late answer is applied at its frame and only later measurements are replayed.
///
/// An answer to a frame that the IMU has not reached is refused as "unknown_stamp". There is no map
/// pose of frames before that of the first applied answer.
class CoupledFusion final : public PoseFusion {
 public:
  CoupledFusion(const ImuNoise& noise, const Config& config);

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
  /// The filter at a frame before the frame's answer, and the IMU data up to it.
  struct FilterState {
    std::optional<Preintegration> from_previous;  ///< none: the IMU does not cover the interval
    MapBodyFilter filter;
  };

  [[nodiscard]] PoseEstimate estimate(const ImuPrediction& in_odom,
                                      const std::optional<ImuPrediction>& in_map,
                                      const MapBodyFilter& filter) const;
  [[nodiscard]] MapBodyFilter after_answer(std::size_t frame) const;
  [[nodiscard]] std::optional<ImuPrediction> predict_in_map(const MapBodyFilter& filter,
                                                            const OdometryEstimate& from,
                                                            Timestamp to) const;
  void propagate_to_new_frames();
  void replay_from(std::size_t frame);
  void propagate_to(std::size_t frame, const MapBodyFilter& previous);

  Config config_;
  DelayedFrames frames_;
  bool interrupted_ = false;
  std::deque<FilterState> filter_states_;        ///< at the frames that the IMU covers
  MapBodyFilter newest_;                         ///< after the answer of the last of them
  std::optional<ImuPrediction> map_prediction_;  ///< from it, at the last IMU sample
};

}  // namespace fleetloc
