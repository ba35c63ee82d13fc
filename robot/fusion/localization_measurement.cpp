#include "robot/fusion/localization_measurement.hpp"

#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "shared/geometry/covariance.hpp"

namespace fleetloc {

Matrix6d clone_covariance(const LocalizationNoise& noise) {
  return diagonal_covariance(noise.clone_rotation, noise.clone_translation);
}

bool reaches_back_to(Timestamp oldest, const LocalizationMeasurement& answer) {
  constexpr std::chrono::milliseconds kRounded{50};  // keyframes are further apart
  return answer.oldest_stamp <= oldest + kRounded;
}

LocalizationMeasurement measurement_from(const LocalizationResult& answer,
                                         const Pose& T_odom_body,
                                         const LocalizationNoise& noise) {
  LocalizationMeasurement result;
  result.stamp = answer.stamp;
  result.oldest_stamp = answer.oldest_stamp;
  result.localizer = answer.localizer;
  result.incarnation = answer.incarnation;
  result.map_hash = answer.map_hash;
  result.T_map_body = answer.T_map_body;
  result.T_odom_body = T_odom_body;

  const Matrix6d map_axes = adjoint({answer.T_map_body.R, Eigen::Vector3d::Zero()});
  result.root_map = symmetric_root(map_axes * answer.covariance * map_axes.transpose());
  result.covariance = answer.covariance + clone_covariance(noise);
  result.white = noise.white_share * answer.covariance + clone_covariance(noise);
  result.J_error = std::sqrt(1.0 - noise.white_share) * map_axes.transpose() * result.root_map;
  result.J_alignment = adjoint(inverse(T_odom_body));
  return result;
}

Matrix6d alignment_covariance(const LocalizationMeasurement& measurement) {
  const Matrix6d A = adjoint(measurement.T_odom_body);
  return A * measurement.covariance * A.transpose();
}

Pose alignment_from(const LocalizationMeasurement& measurement) {
  return measurement.T_map_body * inverse(measurement.T_odom_body);
}

Matrix6d symmetric_root(const Matrix6d& matrix) {
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(matrix);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
         eigen.eigenvectors().transpose();
}

double chi_square(const Vector6d& residual, const Matrix6d& covariance) {
  const Eigen::LLT<Matrix6d> llt(covariance);
  if (llt.info() != Eigen::Success) {
    return std::numeric_limits<double>::infinity();
  }
  return residual.dot(llt.solve(residual));
}

}  // namespace fleetloc
