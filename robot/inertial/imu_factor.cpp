#include "robot/inertial/imu_factor.hpp"

#include <cassert>
#include <utility>

#include <Eigen/Cholesky>

#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

// Where blocks start in a tangent of NavState, and in the error.
constexpr int kRotation = 0;
constexpr int kPosition = 3;
constexpr int kVelocity = 6;
constexpr int kBiases = 9;

// What the factor compares with the deltas, in the body frame of the first state.
struct Motion {
  Eigen::Vector3d position;
  Eigen::Vector3d velocity;
};

Motion motion_between(double time, const NavState& first, const NavState& second) {
  const Eigen::Quaterniond R_body_odom = first.T_odom_body.R.conjugate();
  return {R_body_odom * (second.T_odom_body.p - first.T_odom_body.p - time * first.v_odom -
                         (0.5 * time * time) * kGravity),
          R_body_odom * (second.v_odom - first.v_odom - time * kGravity)};
}

// Forster et al., 2017, eq. 45, and the random walk.
Vector15d error_of(const Preintegration& preintegration,
                   const NavState& first,
                   const NavState& second) {
  const Preintegration::Deltas deltas = preintegration.deltas(first.bias);
  const Motion motion = motion_between(to_seconds(preintegration.duration()), first, second);
  Vector15d error;
  error << log_so3(deltas.R.conjugate() * first.T_odom_body.R.conjugate() * second.T_odom_body.R),
      motion.position - deltas.p, motion.velocity - deltas.v,
      second.bias.gyroscope - first.bias.gyroscope,
      second.bias.accelerometer - first.bias.accelerometer;
  return error;
}

// With respect to the first state; `rotation_error` is that of error_of at the same states.
Matrix15d jacobian_by_first(const Preintegration& preintegration,
                            const NavState& first,
                            const NavState& second,
                            const Eigen::Vector3d& rotation_error) {
  const double time = to_seconds(preintegration.duration());
  const Motion motion = motion_between(time, first, second);
  const Eigen::Matrix3d R_body_odom = first.T_odom_body.R.toRotationMatrix().transpose();
  const Eigen::Matrix3d J_log = right_jacobian_inverse_so3(rotation_error);
  const Eigen::Matrix3d J_rotation_gyroscope = preintegration.bias_jacobian().topLeftCorner<3, 3>();
  const Eigen::Vector3d correction =
      J_rotation_gyroscope * (first.bias.gyroscope - preintegration.bias().gyroscope);

  Matrix15d J = Matrix15d::Zero();
  J.block<3, 3>(kRotation, kRotation) =
      -J_log * (second.T_odom_body.R.conjugate() * first.T_odom_body.R).toRotationMatrix();
  J.block<3, 3>(kRotation, kBiases) = -J_log *
                                      exp_so3(rotation_error).toRotationMatrix().transpose() *
                                      right_jacobian_so3(correction) * J_rotation_gyroscope;
  J.block<3, 3>(kPosition, kRotation) = hat(motion.position);
  J.block<3, 3>(kPosition, kPosition) = -Eigen::Matrix3d::Identity();
  J.block<3, 3>(kPosition, kVelocity) = -time * R_body_odom;
  J.block<3, 3>(kVelocity, kRotation) = hat(motion.velocity);
  J.block<3, 3>(kVelocity, kVelocity) = -R_body_odom;
  J.block<6, 6>(kPosition, kBiases) = -preintegration.bias_jacobian().bottomRows<6>();
  J.block<6, 6>(kBiases, kBiases) = -Matrix6d::Identity();
  return J;
}

Matrix15d jacobian_by_second(const NavState& first,
                             const NavState& second,
                             const Eigen::Vector3d& rotation_error) {
  const Eigen::Quaterniond R_body_odom = first.T_odom_body.R.conjugate();
  Matrix15d J = Matrix15d::Zero();
  J.block<3, 3>(kRotation, kRotation) = right_jacobian_inverse_so3(rotation_error);
  J.block<3, 3>(kPosition, kPosition) = (R_body_odom * second.T_odom_body.R).toRotationMatrix();
  J.block<3, 3>(kVelocity, kVelocity) = R_body_odom.toRotationMatrix();
  J.block<6, 6>(kBiases, kBiases).setIdentity();
  return J;
}

const double* chosen(const double* current, const double* first_estimate) {
  return first_estimate != nullptr ? first_estimate : current;
}

NavState linearization_point(const double* pose,
                             const double* speed_bias,
                             const FirstEstimate& first) {
  return nav_state_from(
      chosen(pose, first.pose != nullptr ? first.pose->data() : nullptr),
      chosen(speed_bias, first.speed_bias != nullptr ? first.speed_bias->data() : nullptr));
}

// Jacobians with respect to one state's two parameter blocks, where Ceres requests them.
void write(const Matrix15d& J, double* J_pose, double* J_speed_bias) {
  if (J_pose != nullptr) {
    RowMajorMap<15, 7> out(J_pose);
    out.leftCols<6>() = J.leftCols<6>();
    out.col(6).setZero();
  }
  if (J_speed_bias != nullptr) {
    RowMajorMap<15, 9>{J_speed_bias} = J.rightCols<9>();
  }
}

}  // namespace

SpeedBiasParameters to_speed_bias(const NavState& state) {
  SpeedBiasParameters parameters;
  Eigen::Map<Vector9d>(parameters.data()) << state.v_odom, state.bias.gyroscope,
      state.bias.accelerometer;
  return parameters;
}

NavState nav_state_from(const double* pose, const double* speed_bias) {
  const Eigen::Map<const Vector9d> values(speed_bias);
  return {pose_from(pose), values.head<3>(), {values.segment<3>(3), values.tail<3>()}};
}

ImuError imu_error(const Preintegration& preintegration,
                   const NavState& first,
                   const NavState& second) {
  ImuError result;
  result.error = error_of(preintegration, first, second);
  const Eigen::Vector3d rotation_error = result.error.head<3>();
  result.J_first = jacobian_by_first(preintegration, first, second, rotation_error);
  result.J_second = jacobian_by_second(first, second, rotation_error);
  return result;
}

Matrix15d imu_error_covariance(const Preintegration& preintegration) {
  const double time = to_seconds(preintegration.bias_walk_duration());
  const ImuNoise& noise = preintegration.noise();
  const double gyroscope = noise.gyroscope_random_walk * noise.gyroscope_random_walk * time;
  const double accelerometer =
      noise.accelerometer_random_walk * noise.accelerometer_random_walk * time;
  Matrix15d covariance = Matrix15d::Zero();
  covariance.topLeftCorner<9, 9>() = preintegration.covariance();
  covariance.topRightCorner<9, 6>() = preintegration.bias_walk_covariance();
  covariance.bottomLeftCorner<6, 9>() = preintegration.bias_walk_covariance().transpose();
  covariance.diagonal().segment<3>(kBiases).setConstant(gyroscope);
  covariance.diagonal().tail<3>().setConstant(accelerometer);
  return covariance;
}

ImuFactor::ImuFactor(Preintegration preintegration, FirstEstimate first, FirstEstimate second)
    : preintegration_(std::move(preintegration)), first_(first), second_(second) {
  const Eigen::LLT<Matrix15d> cholesky(imu_error_covariance(preintegration_));
  assert(cholesky.info() == Eigen::Success);  // all densities of the noise must be positive
  whitening_ = cholesky.matrixL().solve(Matrix15d::Identity());
}

bool ImuFactor::Evaluate(const double* const* parameters,
                         double* residuals,
                         double** jacobians) const {
  const NavState first = nav_state_from(parameters[0], parameters[1]);
  const NavState second = nav_state_from(parameters[2], parameters[3]);
  const auto W = whitening_.triangularView<Eigen::Lower>();
  Eigen::Map<Vector15d>(residuals).noalias() = W * error_of(preintegration_, first, second);
  if (jacobians == nullptr) {
    return true;
  }
  const ImuError linear = imu_error(preintegration_,
                                    linearization_point(parameters[0], parameters[1], first_),
                                    linearization_point(parameters[2], parameters[3], second_));
  if (jacobians[0] != nullptr || jacobians[1] != nullptr) {
    write(W * linear.J_first, jacobians[0], jacobians[1]);
  }
  if (jacobians[2] != nullptr || jacobians[3] != nullptr) {
    write(W * linear.J_second, jacobians[2], jacobians[3]);
  }
  return true;
}

const Preintegration& ImuFactor::preintegration() const {
  return preintegration_;
}

}  // namespace fleetloc
