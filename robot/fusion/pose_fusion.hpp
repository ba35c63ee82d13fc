#pragma once

#include <memory>
#include <optional>

#include "robot/fusion/answer_outcome.hpp"
#include "robot/fusion/map_alignment.hpp"
#include "robot/fusion/odometry_drift.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/core/ids.hpp"
#include "shared/model/inertial.hpp"
#include "shared/model/localization_result.hpp"
#include "shared/model/pose_estimate.hpp"
#include "shared/model/session.hpp"

namespace fleetloc {

/// The robot's pose in odom and map at IMU rate, from IMU, odometry and late, lossy answers of the
/// cloud. A delayed-state filter (Lynen et al. 2013): each measurement is applied at its own stamp
/// and later ones are replayed in order, gates included, so that the order of arrival does not
/// matter. The odom pose is an inertial prediction from the odometry's last state; answers never
/// change it, so it is as smooth as the odometry.
///
/// What the quality of an estimate means for a robot that moves:
/// - kInitializing: there is no pose. Stand still.
/// - kLocalized: the map pose is within 0.25 m and 2 degrees, says its covariance (2.5 sigmas), and
///   an applied answer is at most `localized_for_s` old, so that the cloud would have contradicted
///   a wrong one; time at a standstill does not count. How late answers come does not matter
///   otherwise. Drive.
/// - kDeadReckoning: the map pose is only as good as its covariance says, or nothing has confirmed
///   it for long, or it was carried over a failure of the odometry. Drive on while the covariance
///   fits the space around; slow down, and stop where it does not.
/// - kSearching: there is no map pose yet. Drive, if at all, by the odom pose.
/// - kLost: the map pose must not be used: the localizer has taken it back, or nobody knows how far
///   the robot was carried, or several answers contradict it, or its covariance has
///   grown beyond the configured limit, or the odometry has stopped. Stop, or drive by direct
///   perception only. The odom pose stays usable except in the last case.
///
/// Everything runs in the caller's thread.
class PoseFusion {
 public:
  enum class Formulation {
    kDecoupled,  ///< DecoupledFusion
    kCoupled,    ///< CoupledFusion, the paper's
  };
  struct Config {
    Formulation formulation{};
    double buffer_s = 0.0;             ///< how late an answer may be
    double localized_below_m = 0.0;    ///< sigma of the map position, worst direction
    double localized_below_rad = 0.0;  ///< sigma of the map rotation, worst axis
    double localized_for_s = 0.0;      ///< in motion after the last applied answer, at most
    double odometry_timeout_s = 0.0;   ///< without odometry for longer, kLost
    double lost_beyond_m = 0.0;        ///< sigma of the map position, worst direction
    double lost_beyond_rad = 0.0;      ///< sigma of the map rotation, worst axis
    OdometryDrift::Config drift;
    MapAlignment::Config answers;
  };

  PoseFusion() = default;
  virtual ~PoseFusion() = default;
  PoseFusion(const PoseFusion&) = delete;
  PoseFusion& operator=(const PoseFusion&) = delete;

  /// A sample that is not newer than the last one, or not finite, changes nothing.
  virtual PoseEstimate add_imu(const ImuSample& sample) = 0;

  /// The odometry's state at the stamp of a frame; stamps increase. IMU samples newer than it are
  /// replayed on top.
  virtual expected<void, FusionRejection> add_odometry(const OdometryEstimate& estimate) = 0;

  /// Answers may be late, lost, repeated and out of order. What was said of later ones may change
  /// with this one.
  virtual AnswerOutcome add_answer(const LocalizationResult& answer) = 0;

  /// The current estimate of the pose at a frame's stamp. Nothing unless odometry and buffered IMU
  /// samples cover the stamp: add the first sample after the frame before.
  [[nodiscard]] virtual std::optional<PoseEstimate> estimate_at(Timestamp stamp) const = 0;

  /// The robot may be anywhere: kLost until the next answer with a pose, whatever that pose is. An
  /// answer of status kLost does the same.
  virtual void lose() = 0;

  /// The odometry has failed: until reset() poses are dead-reckoned from its last state, and never
  /// kLocalized.
  virtual void interrupt() = 0;

  /// A new session of the odometry: drops its earlier poses; only answers to this session are used
  /// from now on (before the first call, all). Without `carried`, or if no answer was ever applied,
  /// T_map_odom and its map are dropped, too. Otherwise T_map_odom is `carried` until the first
  /// answer that agrees with it.
  virtual void reset(SessionNumber session, const std::optional<MapOdomEstimate>& carried) = 0;

  /// The robot is searched for in the map anew: T_map_odom and its answers are dropped, only
  /// answers to this session are used from now on. The odometry goes on.
  virtual void forget_map(SessionNumber session) = 0;

  /// The current T_map_odom, with which a session of the cloud can start; from the first applied
  /// answer on, also while lost. Its covariance covers answers that contradict it.
  [[nodiscard]] virtual std::optional<MapOdomEstimate> session_start() const = 0;
};

std::unique_ptr<PoseFusion> make_pose_fusion(const ImuNoise& noise,
                                             const PoseFusion::Config& config);

PoseFusion::Config read_pose_fusion_config(ConfigReader section);

}  // namespace fleetloc
