#include "robot/fusion/odometry_drift.hpp"

#include <initializer_list>

#include <gtest/gtest.h>

#include "test/unit/fusion/fed_fusion.hpp"

namespace fleetloc {
namespace {

constexpr OdometryDrift::Config kConfig{.translation = 0.01,
                                        .yaw = 0.001,
                                        .yaw_by_rotation = 0.002,
                                        .tilt = 0.0001,
                                        .covariance_share = 1.0};

Matrix6d drift_over(OdometryDrift& drift, int steps, const Pose& T_step) {
  Matrix6d sum = Matrix6d::Zero();
  OdometryEstimate estimate;
  for (int i = 0; i <= steps; ++i) {
    sum += drift.step(estimate).covariance;
    estimate.state.T_odom_body = estimate.state.T_odom_body * T_step;
  }
  return sum;
}

TEST(OdometryDrift, IsNothingAtRest) {
  OdometryDrift drift(kConfig);
  EXPECT_EQ(drift_over(drift, 10, {}), Matrix6d::Zero());
}

TEST(OdometryDrift, GrowsWithTheDistanceHoweverFinelyItIsCut) {
  OdometryDrift coarse(kConfig);
  OdometryDrift fine(kConfig);
  const Matrix6d a = drift_over(coarse, 10, {Eigen::Quaterniond::Identity(), {0.0, 0.0, 1.0}});
  const Matrix6d b = drift_over(fine, 100, {Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.1}});
  EXPECT_NEAR(a(5, 5), 10 * 1e-4, 1e-12);
  EXPECT_NEAR(a(2, 2), 10 * 1e-6, 1e-12);
  EXPECT_NEAR(a(5, 5), b(5, 5), 1e-12);
  EXPECT_NEAR(a(2, 2), b(2, 2), 1e-12);
}

TEST(OdometryDrift, GrowsWithTheRotation) {
  OdometryDrift drift(kConfig);
  const Matrix6d Q = drift_over(drift, 10, {exp_so3({0.0, 0.0, 0.3}), Eigen::Vector3d::Zero()});
  EXPECT_NEAR(Q(2, 2), 3.0 * 4e-6, 1e-12);
  EXPECT_EQ(Q(5, 5), 0.0);
}

// Far from the origin an error of yaw turns the map about the robot: the robot's own position does
// not jump.
TEST(OdometryDrift, TurnsAboutTheBody) {
  OdometryDrift drift(kConfig);
  OdometryEstimate estimate;
  estimate.state.T_odom_body.p = {1000.0, 0.0, 0.0};
  drift.step(estimate);
  estimate.state.T_odom_body.p = {1001.0, 0.0, 0.0};
  const Matrix6d Q = drift.step(estimate).covariance;
  const Matrix6d A = adjoint(inverse(estimate.state.T_odom_body));
  const Matrix6d Q_body = A * Q * A.transpose();
  EXPECT_NEAR(Q_body(4, 4), 1e-4, 1e-9);
  EXPECT_NEAR(Q_body(2, 2), 1e-6, 1e-12);
}

double movement_over(std::initializer_list<double> variances) {
  VarianceChange movement;
  double sum = 0.0;
  for (const double variance : variances) {
    const auto [up, down] = movement.update(variance);
    sum += up + down;
  }
  return sum;
}

TEST(OdometryDrift, CountsHowFarAVarianceMoves) {
  EXPECT_DOUBLE_EQ(movement_over({0.01}), 0.0);
  EXPECT_DOUBLE_EQ(movement_over({0.01, 0.03, 0.05}), 0.04);
  EXPECT_DOUBLE_EQ(movement_over({0.05, 0.03, 0.01}), 0.04);
  EXPECT_DOUBLE_EQ(movement_over({0.01, 0.05, 0.02, 0.06}), 0.04 + 0.03 + 0.04);
}

TEST(OdometryDrift, CountsNoFluctuationOfAVariance) {
  EXPECT_DOUBLE_EQ(movement_over({1.0, 0.8, 1.0, 0.8, 1.25, 0.9}), 0.25);
  EXPECT_DOUBLE_EQ(movement_over({1.0, 0.5, 0.6, 0.5, 0.6}), 0.5);
}

/// Errors of the rotation (roll, pitch, yaw) that have turned the way about its beginning, 40 m
/// back, and some of the position itself.
Matrix6d covariance_after_straight_way(const Eigen::Vector3d& rotation_sigmas,
                                       double position_sigma_m) {
  Matrix6d J = Matrix6d::Identity();
  J.bottomLeftCorner<3, 3>() = -hat(Eigen::Vector3d(40.0, 0.0, 0.0));
  Vector6d variances;
  variances << rotation_sigmas.cwiseAbs2(),
      Eigen::Vector3d::Constant(position_sigma_m * position_sigma_m);
  return J * variances.asDiagonal() * J.transpose();
}

TEST(OdometryDrift, IsNotWhatAnOldErrorOfTheRotationDoesFartherOn) {
  const OdometryDrift::Config config{.covariance_share = 1.0};
  OdometryDrift drift(config);
  OdometryEstimate estimate;
  for (const double metres : {0.0, 10.0, 20.0, 30.0, 40.0}) {
    Matrix6d J = Matrix6d::Identity();
    J.bottomLeftCorner<3, 3>() = -hat(Eigen::Vector3d(metres, 0.0, 0.0));
    estimate.state.T_odom_body.p.x() = metres;
    estimate.covariance.topLeftCorner<6, 6>() = 1e-4 * J * J.transpose();
    EXPECT_LT(drift.step(estimate).covariance.norm(), 1e-12);
  }
}

// The yaw of an odometry is a random walk, and its position the integral: after a kilometre the
// covariance of the position grows by metres with each metre, but T_map_odom drifts as in the
// first.
TEST(OdometryDrift, IsTheSameAfterAKilometreAsInTheFirstMetre) {
  constexpr double kYawVariance = 1e-6;       // new with each metre
  constexpr double kPositionVariance = 1e-5;  // of each axis
  OdometryDrift drift({.covariance_share = 1.0});
  OdometryEstimate estimate;
  Matrix6d step = Matrix6d::Identity();
  step.block<3, 1>(3, 2) = Eigen::Vector3d::UnitZ().cross(Eigen::Vector3d::UnitX());
  Matrix6d covariance = Matrix6d::Zero();
  for (int metre = 0; metre <= 1000; ++metre) {
    estimate.state.T_odom_body.p.x() = metre;
    estimate.covariance.topLeftCorner<6, 6>() = covariance;
    const Matrix6d drifted = drift.step(estimate).covariance;
    const Matrix6d A = adjoint(inverse(estimate.state.T_odom_body));
    const Matrix6d at_the_body = A * drifted * A.transpose();
    if (metre > 0) {
      EXPECT_NEAR(at_the_body(2, 2), kYawVariance, 1e-9) << metre;
      EXPECT_NEAR(at_the_body(4, 4), kPositionVariance, 1e-8) << metre;
    }
    covariance = step * covariance * step.transpose();
    covariance(2, 2) += kYawVariance;
    covariance.diagonal().tail<3>().array() += kPositionVariance;
  }
  EXPECT_GT(covariance(4, 4), 300.0);  // (17 m)^2
}

// An optimal estimate that learns its tilt: what it moves by is what it becomes surer of.
TEST(OdometryDrift, IsWhatAnEstimateIsRevisedBy) {
  const Matrix6d before = covariance_after_straight_way({0.015, 0.012, 0.02}, 0.1);
  Eigen::Matrix<double, 2, 6> H = Eigen::Matrix<double, 2, 6>::Zero();
  H.leftCols<2>().setIdentity();
  const Eigen::Matrix2d R = Eigen::Vector2d(1e-5, 2e-5).asDiagonal();
  const Eigen::Matrix2d S = H * before * H.transpose() + R;
  const Eigen::Matrix<double, 6, 2> K = before * H.transpose() * S.inverse();
  const Matrix6d revision = K * S * K.transpose();

  OdometryDrift drift({.covariance_share = 1.0});
  OdometryEstimate estimate;
  estimate.state.T_odom_body = {exp_so3({0.0, 0.0, 0.7}), {20.0, 30.0, 1.0}};
  const auto at_the_body = [&](const Matrix6d& in_odom_axes) {
    const Matrix6d A = adjoint({estimate.state.T_odom_body.R.conjugate(), Eigen::Vector3d::Zero()});
    return Matrix6d(A * in_odom_axes * A.transpose());
  };
  estimate.covariance.topLeftCorner<6, 6>() = at_the_body(before);
  drift.step(estimate);
  estimate.covariance.topLeftCorner<6, 6>() = at_the_body(before - revision);
  const Matrix6d moved = drift.step(estimate).covariance;

  const Matrix6d A = adjoint({Eigen::Quaterniond::Identity(), estimate.state.T_odom_body.p});
  const Matrix6d expected = A * revision * A.transpose();
  EXPECT_LT((moved - expected).norm(), 1e-9 * expected.norm()) << moved << "\n\n" << expected;
}

TEST(VarianceChange, CountsEveryStepOfOneDirection) {
  VarianceChange change;
  EXPECT_EQ(change.update(1.0).up, 0.0);  // the first has nothing to compare with
  EXPECT_DOUBLE_EQ(change.update(1.5).up, 0.5);
  EXPECT_DOUBLE_EQ(change.update(3.0).up, 1.5);
}

TEST(VarianceChange, IgnoresAReversalByLessThanItsHysteresis) {
  VarianceChange change;
  change.update(1.0);
  change.update(2.0);
  EXPECT_EQ(change.update(1.5).down, 0.0);  // by a quarter
  EXPECT_EQ(change.update(2.0).up, 0.0);    // back where it was: no growth either
  EXPECT_NEAR(change.update(2.2).up, 0.2, 1e-12);
}

TEST(VarianceChange, CountsALargerReversalWhole) {
  VarianceChange change;
  change.update(1.0);
  change.update(2.0);
  EXPECT_DOUBLE_EQ(change.update(1.0).down, 1.0);
  EXPECT_EQ(change.update(1.2).up, 0.0);
  EXPECT_DOUBLE_EQ(change.update(1.6).up, 0.6);
}

}  // namespace
}  // namespace fleetloc
