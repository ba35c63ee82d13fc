#include "robot/vio/inertial_alignment.hpp"

#include <cassert>
#include <cmath>

#include <Eigen/Cholesky>

#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

constexpr int kGyroscopeIterations = 3;
constexpr int kGravityIterations = 4;

// From the difference between integrated and visual rotations.
Eigen::Vector3d gyroscope_bias(std::span<const Pose> T_first_body,
                               const std::vector<Preintegration>& between) {
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  ImuBias bias = between.front().bias();
  for (std::size_t i = 0; i < between.size(); ++i) {
    const Eigen::Quaterniond R_seen = T_first_body[i].R.conjugate() * T_first_body[i + 1].R;
    const Eigen::Vector3d error =
        log_so3(between[i].deltas(between[i].bias()).R.conjugate() * R_seen);
    const Eigen::Matrix3d J = between[i].bias_jacobian().topLeftCorner<3, 3>();
    H += J.transpose() * J;
    g += J.transpose() * error;
  }
  return bias.gyroscope + H.ldlt().solve(g);
}

void relinearize(std::vector<Preintegration>& between, const ImuBias& bias) {
  for (Preintegration& one : between) {
    one = one.relinearized(bias);
  }
}

// Unknowns: velocities (3 each), gravity as g0 + B u, accelerometer bias. Both ends of every
// preintegration give six equations.
struct LinearSystem {
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
};

LinearSystem assemble(std::span<const Pose> T_first_body,
                      const std::vector<Preintegration>& between,
                      const AlignmentNoise& noise,
                      const Eigen::Vector3d& g0,
                      const Eigen::MatrixXd& B) {
  const auto n = static_cast<Eigen::Index>(T_first_body.size());
  const Eigen::Index gravity = 3 * n;
  const Eigen::Index bias = gravity + B.cols();
  LinearSystem system{Eigen::MatrixXd::Zero(bias + 3, bias + 3), Eigen::VectorXd::Zero(bias + 3)};
  for (std::size_t i = 0; i < between.size(); ++i) {
    const double dt = to_seconds(between[i].duration());
    const Preintegration::Deltas deltas = between[i].deltas(between[i].bias());
    const Eigen::Matrix3d R = T_first_body[i].R.toRotationMatrix();
    const auto column = static_cast<Eigen::Index>(3 * i);
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(6, bias + 3);
    Eigen::Matrix<double, 6, 1> b;
    A.block<3, 3>(0, column).diagonal().setConstant(dt);
    A.block(0, gravity, 3, B.cols()) = 0.5 * dt * dt * B;
    A.block<3, 3>(0, bias) = R * between[i].bias_jacobian().block<3, 3>(3, 3);
    A.block<3, 3>(3, column).diagonal().setConstant(1.0);
    A.block<3, 3>(3, column + 3).diagonal().setConstant(-1.0);
    A.block(3, gravity, 3, B.cols()) = dt * B;
    A.block<3, 3>(3, bias) = R * between[i].bias_jacobian().block<3, 3>(6, 3);
    b.head<3>() = T_first_body[i + 1].p - T_first_body[i].p - 0.5 * dt * dt * g0 - R * deltas.p;
    b.tail<3>() = -dt * g0 - R * deltas.v;
    const double velocity_sigma =
        std::sqrt(between[i].covariance().bottomRightCorner<3, 3>().trace() / 3.0);
    A.topRows<3>() /= noise.position_sigma_m;
    b.head<3>() /= noise.position_sigma_m;
    A.bottomRows<3>() /= velocity_sigma;
    b.tail<3>() /= velocity_sigma;
    system.H += A.transpose() * A;
    system.g += A.transpose() * b;
  }
  system.H.bottomRightCorner<3, 3>().diagonal().array() +=
      std::pow(noise.accelerometer_bias_sigma, -2);
  return system;
}

Eigen::MatrixXd tangent_basis(const Eigen::Vector3d& direction) {
  Eigen::MatrixXd B(3, 2);
  B.col(0) = direction.unitOrthogonal();
  B.col(1) = direction.normalized().cross(Eigen::Vector3d(B.col(0)));
  return B;
}

}  // namespace

InertialAlignment align_inertially(std::span<const Pose> T_first_body,
                                   std::vector<Preintegration> between,
                                   const AlignmentNoise& noise) {
  assert(between.size() > 1 && T_first_body.size() == between.size() + 1);
  InertialAlignment result;
  for (int i = 0; i < kGyroscopeIterations; ++i) {
    result.bias.gyroscope = gyroscope_bias(T_first_body, between);
    relinearize(between, result.bias);
  }
  const auto gravity = static_cast<Eigen::Index>(3 * T_first_body.size());
  const LinearSystem free =
      assemble(T_first_body, between, noise, Eigen::Vector3d::Zero(), Eigen::Matrix3d::Identity());
  Eigen::VectorXd x = free.H.ldlt().solve(free.g);
  result.g_first = x.segment<3>(gravity);
  result.estimated_gravity = result.g_first.norm();
  for (int i = 0; i < kGravityIterations; ++i) {
    result.g_first *= kGravity.norm() / result.g_first.norm();
    const Eigen::MatrixXd B = tangent_basis(result.g_first);
    const LinearSystem system = assemble(T_first_body, between, noise, result.g_first, B);
    x = system.H.ldlt().solve(system.g);
    result.g_first += B * x.segment<2>(gravity);
  }
  result.g_first *= kGravity.norm() / result.g_first.norm();
  result.bias.accelerometer = x.tail<3>();
  for (std::size_t i = 0; i < T_first_body.size(); ++i) {
    result.v_first.emplace_back(x.segment<3>(static_cast<Eigen::Index>(3 * i)));
  }
  return result;
}

}  // namespace fleetloc
