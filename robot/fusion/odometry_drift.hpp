#pragma once

#include <array>
#include <optional>

#include "shared/config/config_reader.hpp"
#include "shared/model/inertial.hpp"

namespace fleetloc {

/// Process noise of T_map_odom from one estimate of the odometry to the next.
struct DriftStep {
  Matrix6d covariance = Matrix6d::Zero();  ///< right perturbation of T_map_odom
  double metres = 0.0;                     ///< distance travelled [m]
  Duration standstill{};                   ///< the time of it, if the robot stood still
};

/// Increase and decrease of a variance, with hysteresis: a reversal by less than the share
/// kHysteresis is ignored as fluctuation.
class VarianceChange {
 public:
  static constexpr double kHysteresis = 0.3;

  struct Step {
    double up = 0.0;
    double down = 0.0;
  };
  /// Change since the last call; zero for the first.
  Step update(double variance);

 private:
  std::optional<double> level_;
  bool rises_ = true;
};

/// Drift model of T_map_odom: a random walk whose variance grows with the distance and rotation
/// travelled, and with changes of the odometry's own covariance.
///
/// Yaw and position are not observable to the odometry: what their covariance gains beyond what an
/// old yaw error does to the position while the robot drives on is new drift.
///
/// Roll and pitch are. An increase of their variance is new drift, a decrease means that the
/// odometry has corrected an earlier error, so that its poses move by as much: on a straight path a
/// bias of the accelerometer looks like a tilt, and the first turn separates them. What depends on
/// the tilt is not counted with yaw and position: an old tilt is part of T_map_odom.
class OdometryDrift {
 public:
  struct Config {
    double translation = 0.0;       ///< each axis [m / sqrt(m travelled)]
    double yaw = 0.0;               ///< [rad / sqrt(m travelled)]
    double yaw_by_rotation = 0.0;   ///< [rad / sqrt(rad turned)]
    double tilt = 0.0;              ///< roll and pitch each [rad / sqrt(m travelled)]
    double covariance_share = 0.0;  ///< of the changes of the odometry's own covariance
  };
  explicit OdometryDrift(const Config& config);

  /// From the estimate of the last call to this one; zero for the first.
  DriftStep step(const OdometryEstimate& estimate);

 private:
  /// Of the odometry at one frame, at the body in odom axes.
  struct Reported {
    Timestamp stamp;
    Pose T_odom_body;
    Eigen::Matrix4d yaw_and_position;  ///< covariance, given the tilt
  };
  Matrix6d reported_drift(const OdometryEstimate& estimate);

  Config config_;
  std::optional<Reported> last_;
  std::array<VarianceChange, 2> tilt_changes_;  ///< about x and y
};

OdometryDrift::Config read_odometry_drift_config(ConfigReader section);

}  // namespace fleetloc
