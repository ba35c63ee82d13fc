#pragma once

#include <string>

#include "shared/core/ids.hpp"
#include "shared/core/time.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/model/localization_result.hpp"

namespace fleetloc {

/// Error model of the answers.
struct LocalizationNoise {
  double white_share = 0.0;        ///< of an answer's covariance that is white noise, 0..1
  double clone_rotation = 0.0;     ///< sigma of one frame's T_odom_body, each axis [rad]
  double clone_translation = 0.0;  ///< [m]
};

/// An answer as a measurement of T_map_odom: T_map_body beside the robot's own T_odom_body of the
/// same stamp. With T_map_odom * Exp(d) the true alignment, its error is, to first order,
///
///   Log((T_map_odom * T_odom_body)^-1 * T_map_body) = J_alignment * d + J_error * u + white.
///
/// Answers share most of their window and all of their map, so most of their error is correlated
/// over many seconds. That part is J_error * u, where u is a first-order Gauss-Markov process of
/// unit variance in map axes: an error of the map does not turn with the robot.
struct LocalizationMeasurement {
  Timestamp stamp;
  Timestamp oldest_stamp;  ///< where the window of the answer begins; it ends at stamp
  std::string localizer;
  Incarnation incarnation{};
  MapHash map_hash{};
  Pose T_map_body;
  Pose T_odom_body;
  Matrix6d covariance;  ///< of the whole error: the answer's and the clone's
  Matrix6d white;       ///< its white part
  Matrix6d J_alignment;
  Matrix6d J_error;
  Matrix6d root_map;  ///< symmetric root of the answer's covariance, in map axes
};

/// Whether the answer's window begins no later than this one. Stamps of older keyframes and windows
/// are rounded to milliseconds on their way, so the same beginning differs a little.
bool reaches_back_to(Timestamp oldest, const LocalizationMeasurement& answer);

/// Covariance (right perturbation) of one frame's T_odom_body.
Matrix6d clone_covariance(const LocalizationNoise& noise);

LocalizationMeasurement measurement_from(const LocalizationResult& answer,
                                         const Pose& T_odom_body,
                                         const LocalizationNoise& noise);

/// Covariance (right perturbation) of alignment_from(measurement).
Matrix6d alignment_covariance(const LocalizationMeasurement& measurement);

/// T_map_odom from this measurement alone: T_map_body * T_odom_body^-1.
Pose alignment_from(const LocalizationMeasurement& measurement);

/// The symmetric root of a positive semi-definite matrix.
Matrix6d symmetric_root(const Matrix6d& matrix);

/// r^T S^-1 r; infinite unless S is positive definite.
double chi_square(const Vector6d& residual, const Matrix6d& covariance);

}  // namespace fleetloc
