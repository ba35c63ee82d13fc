#pragma once

#include <deque>
#include <optional>
#include <string_view>

#include "robot/fusion/imu_prediction.hpp"
#include "robot/fusion/map_alignment.hpp"
#include "robot/fusion/odometry_drift.hpp"
#include "robot/inertial/imu_buffer.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/core/ids.hpp"
#include "shared/model/answer.hpp"
#include "shared/model/inertial.hpp"
#include "shared/model/pose_estimate.hpp"
#include "shared/model/session.hpp"

namespace fleetloc {

/// The robot's pose in odom and map at IMU rate, from IMU, odometry and late, lossy answers of the
/// cloud. Delayed-state filter (Lynen et al. 2013) in two blocks:
///
/// - odom: inertial prediction from the odometry's last state. Answers never touch it, so the odom
///   pose is as smooth as the odometry.
/// - map: T_map_odom (MapAlignment). An answer is a measurement of it at the answer's own stamp,
///   against the odometry's estimate of that frame; what came after is then replayed in order,
///   with all decisions, so that the order of arrival does not matter.
///
/// What the quality of an estimate means for a robot that moves:
/// - kInitializing: there is no pose. Stand still.
/// - kLocalized: drive.
/// - kDeadReckoning: the map pose is as good as its covariance says, which grows with the distance.
///   Drive on while the covariance fits the space around; slow down, and stop where it does not.
/// - kLost: the map pose must not be used: no answer yet, or several answers contradict it, or the
///   odometry has fallen silent. Stop, or go on by what sensors see at once. The odom pose stays
///   usable in the first two cases.
///
/// Approximations: the covariance of T_map_body is that of T_map_odom at the newest frame, moved to
/// the body, plus the noise of one frame, plus the inertial prediction since that frame; these
/// three are taken as independent. Frames keep the odometry's causal estimate: a later revision of
/// a keyframe is not taken over. T_map_odom is linearized about the estimate (EKF, not iterated).
///
/// Everything runs in the caller's thread.
class PoseFusion {
 public:
  struct Config {
    double buffer_s = 0.0;            ///< how late an answer may be
    double localized_for_s = 0.0;     ///< after the stamp of the last applied answer
    double odometry_timeout_s = 0.0;  ///< without odometry for longer, kLost
    OdometryDrift::Config drift;
    MapAlignment::Config answers;
  };

  /// What became of a measurement. Of odometry: "applied", "not_finite", "older_than_applied",
  /// "before_imu". Of an answer: the names of AnswerOutcome, and
  /// - "not_localized": it has no pose;
  /// - "not_finite", "bad_covariance": it cannot be used;
  /// - "wrong_session": it belongs to another start of the odometry;
  /// - "too_old": older than the buffer; "unknown_stamp": no frame of the odometry has that stamp;
  /// - "duplicate": this one, or as good a one, has been taken; "older_than_applied": a newer
  ///   revision has.
  struct Verdict {
    bool applied = false;
    std::string_view reason;
    int revised = 0;  ///< verdicts on later answers that the replay has turned
  };

  PoseFusion(const ImuNoise& noise, const Config& config);

  /// A sample that is not newer than the last one, or not finite, changes nothing.
  PoseEstimate add_imu(const ImuSample& sample);

  /// The odometry's state at the stamp of a frame; stamps increase. IMU samples newer than it are
  /// replayed on top.
  Verdict add_odometry(const OdometryEstimate& estimate);

  /// Answers in any order, repeated or not at all.
  Verdict add_answer(const Answer& answer);

  /// The pose at a frame's stamp, by what is known now. Nothing unless odometry and IMU samples of
  /// the buffer cover the stamp: so add the sample after a frame first.
  [[nodiscard]] std::optional<PoseEstimate> estimate_at(Timestamp stamp) const;

  /// The odometry has failed: until it starts anew poses are dead-reckoned from its last state, and
  /// never count as localized.
  void interrupt() { interrupted_ = true; }

  /// The odometry starts anew: its poses are forgotten, and only answers of this session count from
  /// now on. Before the first call all do. T_map_odom becomes `carried` until the first answer that
  /// agrees with it; without it, or if there never was an answer, it is forgotten.
  void reset(SessionNumber session, const std::optional<StartPose>& carried = std::nullopt);

  /// T_map_odom as it is now, to start a session of the cloud with; from the first applied answer
  /// on, also while lost.
  [[nodiscard]] std::optional<StartPose> start_pose() const;

 private:
  struct StoredAnswer {
    Revision revision{};
    AnswerMeasurement measurement;
    std::optional<AnswerOutcome> outcome;  ///< none before the first replay
  };
  struct Frame {
    OdometryEstimate odometry;
    DriftStep drift;  ///< since the frame before
    std::optional<StoredAnswer> answer;
  };

  [[nodiscard]] std::string_view why_unusable(const Answer& answer) const;
  [[nodiscard]] std::string_view why_no_frame(Timestamp stamp) const;
  [[nodiscard]] PoseEstimate estimate(const ImuPrediction& prediction) const;
  [[nodiscard]] Matrix6d map_covariance(const StartPose& alignment,
                                        const ImuPrediction& prediction) const;
  [[nodiscard]] Quality quality_at(Timestamp stamp) const;
  void predict_from_newest_frame();
  void forget_old_frames();
  int replay_answers();

  ImuNoise noise_;
  Config config_;
  std::optional<SessionNumber> session_;
  bool interrupted_ = false;
  ImuBuffer imu_;
  std::optional<ImuSample> last_imu_;
  std::deque<Frame> frames_;                 ///< the last buffer_s of the odometry
  bool newest_frame_is_ahead_ = false;       ///< of the IMU: prediction_ is from the one before
  std::optional<ImuPrediction> prediction_;  ///< at last_imu_
  OdometryDrift drift_;
  MapAlignment oldest_;     ///< just before frames_.front()
  MapAlignment alignment_;  ///< at frames_.back()
};

PoseFusion::Config read_pose_fusion_config(ConfigReader section);

}  // namespace fleetloc
