#pragma once

#include <array>
#include <optional>

#include "shared/config/config_reader.hpp"
#include "shared/model/inertial.hpp"

namespace fleetloc {

/// What happens to T_map_odom from one estimate of the odometry to the next.
struct DriftStep {
  Matrix6d covariance = Matrix6d::Zero();  ///< that it accrues, right perturbation
  double metres = 0.0;                     ///< travelled
};

/// How far a variance has moved, up and down alike. What returns before it has changed by
/// `kTurn` of itself is fluctuation and does not count.
class VarianceMovement {
 public:
  static constexpr double kTurn = 0.3;

  struct Step {
    double up = 0.0;
    double down = 0.0;
  };
  /// Since the last call; nothing for the first.
  Step to(double variance);

 private:
  std::optional<double> level_;
  bool rises_ = true;
};

/// How far T_map_odom moves as the odometry goes on: a random walk whose steps grow with the
/// distance and the rotation travelled, and with the covariance that the odometry states of itself.
///
/// That covariance counts where it grows, because the odometry loses its way, and where it shrinks,
/// because the odometry then revises what it said before, as much as it has become surer of: along
/// a straight way a bias of the accelerometer is a tilt, and the first bend tells them apart. What
/// an old error of the rotation does to the position as the robot drives on is no movement.
class OdometryDrift {
 public:
  struct Config {
    double translation = 0.0;       ///< each axis [m / sqrt(m travelled)]
    double yaw = 0.0;               ///< [rad / sqrt(m travelled)]
    double yaw_by_rotation = 0.0;   ///< [rad / sqrt(rad turned)]
    double tilt = 0.0;              ///< roll and pitch each [rad / sqrt(m travelled)]
    double covariance_share = 0.0;  ///< of the movement of the odometry's own covariance
  };
  explicit OdometryDrift(const Config& config);

  /// From the last estimate given here to this one; zero for the first.
  DriftStep step(const OdometryEstimate& estimate);

 private:
  Matrix6d claimed(const OdometryEstimate& estimate);

  Config config_;
  std::optional<Pose> last_T_odom_body_;
  std::array<VarianceMovement, 6> movements_;  // rotation; position apart from it; odom axes
};

OdometryDrift::Config read_odometry_drift_config(ConfigReader section);

}  // namespace fleetloc
