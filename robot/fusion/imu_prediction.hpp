#pragma once

#include <optional>
#include <span>

#include "robot/inertial/preintegration.hpp"
#include "shared/core/time.hpp"
#include "shared/model/inertial.hpp"

namespace fleetloc {

/// Inertial dead reckoning from a state of the odometry. Errors are in NavState's tangent; the
/// error at `stamp` is transition * (error at the start) + noise.
struct ImuPrediction {
  Timestamp stamp;
  NavState state;
  Matrix15d start_covariance = Matrix15d::Zero();
  Matrix15d transition = Matrix15d::Identity();  ///< of the error since the start
  Matrix15d noise = Matrix15d::Zero();           ///< covariance added by the IMU since the start
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< of body, in body [rad/s]
  std::optional<Timestamp> gap_start;  ///< last sample before a gap that is not bridged
};

/// One step, from the sample at `prediction.stamp` to the next one. The interval's mean is applied
/// (midpoint rule), as in Preintegration. After a gap longer than ImuGapModel::void_from_s the pose
/// stays constant and its covariance grows by the assumed bounds on the motion.
void advance(ImuPrediction& prediction,
             const ImuSample& from,
             const ImuSample& to,
             const ImuNoise& noise);

/// The same through a preintegrated interval, but for stamp and angular velocity.
void advance(ImuPrediction& prediction, const Preintegration& step);

/// All steps through `samples`, the first of which is at the stamp of `start`. At least one.
ImuPrediction predict(const OdometryEstimate& start,
                      std::span<const ImuSample> samples,
                      const ImuNoise& noise);

/// State transition matrix of the error over a preintegrated interval.
Matrix15d transition_of(const Preintegration& step, const NavState& from, const NavState& to);

/// Covariance (right perturbation) of the predicted T_odom_body.
Matrix6d pose_covariance(const ImuPrediction& prediction);

/// The same, with the pose at the start taken as known.
Matrix6d pose_covariance_since_start(const ImuPrediction& prediction);

}  // namespace fleetloc
