#include "robot/fusion/odometry_drift.hpp"

#include <numbers>

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

TEST(OdometryDrift, CountsOnlyNewMaximaOfTheOdometrysVariance) {
  OdometryDrift drift(kConfig);
  OdometryEstimate estimate;
  Matrix6d sum = Matrix6d::Zero();
  for (const double variance : {0.01, 0.03, 0.02, 0.03, 0.05, 0.01}) {
    estimate.covariance(5, 5) = variance;
    sum += drift.step(estimate).covariance;
  }
  EXPECT_NEAR(sum(5, 5), 0.04, 1e-12);
}

}  // namespace
}  // namespace fleetloc
