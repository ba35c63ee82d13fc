#pragma once

#include <optional>

#include "shared/config/config_reader.hpp"
#include "shared/model/inertial.hpp"

namespace fleetloc {

/// What happens to T_map_odom from one estimate of the odometry to the next.
struct DriftStep {
  Matrix6d covariance = Matrix6d::Zero();  ///< that it accrues, right perturbation
  double metres = 0.0;                     ///< travelled
};

/// How uncertain T_map_odom becomes as the odometry goes on: a random walk whose steps grow with
/// the distance and the rotation travelled, and with the covariance that the odometry claims.
/// Gravity holds roll and pitch of `odom`, so nearly all drift of the rotation is about its z.
class OdometryDrift {
 public:
  struct Config {
    double translation = 0.0;       ///< each axis [m / sqrt(m travelled)]
    double yaw = 0.0;               ///< [rad / sqrt(m travelled)]
    double yaw_by_rotation = 0.0;   ///< [rad / sqrt(rad turned)]
    double tilt = 0.0;              ///< roll and pitch each [rad / sqrt(m travelled)]
    double covariance_share = 0.0;  ///< of the growth of the odometry's own variances that counts
  };
  explicit OdometryDrift(const Config& config);

  /// From the last estimate given here to this one; zero for the first.
  DriftStep step(const OdometryEstimate& estimate);

 private:
  /// Variances of [x, y, z, yaw] in odom axes. Only a new maximum counts as growth, so that
  /// estimates that fluctuate do not add up.
  Eigen::Vector4d growth(const OdometryEstimate& estimate);

  Config config_;
  std::optional<Pose> last_T_odom_body_;
  Eigen::Vector4d largest_variance_ = Eigen::Vector4d::Zero();
};

OdometryDrift::Config read_odometry_drift_config(ConfigReader section);

}  // namespace fleetloc
