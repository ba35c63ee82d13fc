#include "robot/fusion/imu_prediction.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "test/unit/fusion/fed_fusion.hpp"
#include "test/unit/geometry/numeric_jacobian.hpp"

namespace fleetloc {
namespace {

Vector15d local_coordinates(const NavState& from, const NavState& to) {
  Vector15d xi;
  xi << log_so3(from.T_odom_body.R.conjugate() * to.T_odom_body.R),
      from.T_odom_body.R.conjugate() * (to.T_odom_body.p - from.T_odom_body.p),
      to.v_odom - from.v_odom, to.bias.gyroscope - from.bias.gyroscope,
      to.bias.accelerometer - from.bias.accelerometer;
  return xi;
}

NavState some_state() {
  NavState state;
  state.T_odom_body = {exp_so3({0.3, -0.2, 0.9}), {1.0, 2.0, -1.0}};
  state.v_odom = {0.5, -1.0, 0.2};
  state.bias = {.gyroscope = {0.01, -0.02, 0.03}, .accelerometer = {0.1, 0.05, -0.2}};
  return state;
}

TEST(ImuPrediction, GoesStraightWithoutForce) {
  OdometryEstimate start;
  start.state.v_odom = {1.0, -2.0, 0.5};
  std::vector<ImuSample> samples;
  for (int i = 0; i <= 200; ++i) {
    samples.push_back({at(0.005 * i), Eigen::Vector3d::Zero(), -kGravity});
  }
  const ImuPrediction end = predict(start, samples, euroc_imu_noise());
  EXPECT_LT((end.state.T_odom_body.p - start.state.v_odom).norm(), 1e-9);
  EXPECT_LT((end.state.v_odom - start.state.v_odom).norm(), 1e-9);
  EXPECT_EQ(end.stamp, at(1.0));
}

TEST(ImuPrediction, FollowsACircle) {
  const CircularDrive drive;
  std::vector<ImuSample> samples;
  for (int i = 0; i <= 400; ++i) {
    samples.push_back(drive.imu(0.005 * i));
  }
  const ImuPrediction end = predict(odometry(0.0, drive.state(0.0)), samples, euroc_imu_noise());
  EXPECT_LT(local_coordinates(drive.state(2.0), end.state).norm(), 1e-5);
  EXPECT_NEAR(end.angular_velocity.z(), drive.turn_rate(), 1e-12);
}

TEST(ImuPrediction, TransitionAgreesWithDifferences) {
  std::vector<ImuSample> samples;
  for (int i = 0; i <= 20; ++i) {
    const double t = 0.005 * i;
    samples.push_back({at(t), {std::sin(9 * t), 0.5, -1.0 + t}, {1.0 - t, std::cos(t), 9.0}});
  }
  const NavState start = some_state();
  const Preintegration step(samples, start.bias, euroc_imu_noise());
  const NavState end = step.predict(start);
  const auto numeric = numeric_jacobian_at_zero<15>([&](const Vector15d& xi) -> Vector15d {
    return local_coordinates(end, step.predict(retract(start, xi)));
  });
  EXPECT_LT((transition_of(step, start, end) - numeric).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(ImuPrediction, ChainsToTheTransitionOfTheWholeInterval) {
  std::vector<ImuSample> samples;
  for (int i = 0; i <= 20; ++i) {
    samples.push_back({at(0.005 * i), {0.1, 0.5, -1.0}, {1.0, 0.2, 9.0}});
  }
  OdometryEstimate start;
  start.state = some_state();
  const ImuPrediction chained = predict(start, samples, euroc_imu_noise());
  const Preintegration whole(samples, start.state.bias, euroc_imu_noise());
  const NavState end = whole.predict(start.state);
  EXPECT_LT(local_coordinates(end, chained.state).norm(), 1e-9);
  EXPECT_LT((transition_of(whole, start.state, end) - chained.transition).cwiseAbs().maxCoeff(),
            1e-6);
}

// Continuous white noise of density s integrates to s^2 t in velocity, s^2 t^3 / 3 in position.
TEST(ImuPrediction, NoiseGrowsAsInClosedForm) {
  const ImuNoise noise{.accelerometer_noise_density = 0.01};
  OdometryEstimate start;
  std::vector<ImuSample> samples;
  for (int i = 0; i <= 400; ++i) {
    samples.push_back({at(0.005 * i), Eigen::Vector3d::Zero(), -kGravity});
  }
  const Matrix6d covariance = pose_covariance(predict(start, samples, noise));
  EXPECT_NEAR(covariance(4, 4), 1e-4 * 8.0 / 3.0, 1e-4 * 0.01);
  EXPECT_NEAR(covariance(0, 0), 0.0, 1e-15);
}

TEST(ImuPrediction, KeepsThePoseOfTheStartOutOfWhatAroseSince) {
  OdometryEstimate start = odometry(0.0, some_state());
  start.covariance.topLeftCorner<6, 6>() *= 1e4;
  std::vector<ImuSample> samples;
  for (int i = 0; i <= 20; ++i) {
    samples.push_back({at(0.005 * i), Eigen::Vector3d::Zero(), -kGravity});
  }
  const ImuPrediction end = predict(start, samples, euroc_imu_noise());
  EXPECT_GT(pose_covariance(end)(3, 3), 1.0);
  EXPECT_NEAR(pose_covariance_since_start(end)(3, 3), 0.01 * 1e-4, 1e-7);  // velocity: (0.1 s)^2
}

TEST(ImuPrediction, HoldsThePoseAfterAGapThatTellsNothing) {
  ImuNoise noise = euroc_imu_noise();
  noise.gaps = {.bridged_from_s = 0.03,
                .angular_acceleration = 0.3,
                .jerk = 4.0,
                .void_from_s = 0.5,
                .speed_sigma = 1.0,
                .turn_rate_sigma = 0.5};
  const CircularDrive drive;
  std::vector<ImuSample> samples;
  for (const double t : {0.0, 0.01, 0.02, 2.02, 2.03, 4.02}) samples.push_back(drive.imu(t));
  const ImuPrediction end = predict(odometry(0.0, drive.state(0.0)), samples, noise);
  EXPECT_EQ(end.gap_start, at(0.02));
  EXPECT_EQ(end.stamp, at(4.02));
  EXPECT_LT((end.state.T_odom_body.p - drive.pose(0.02).p).norm(), 1e-3);
  EXPECT_EQ(end.state.v_odom, Eigen::Vector3d::Zero());
  // As after 4 s of a constant velocity that is not known.
  const Matrix6d covariance = pose_covariance(end);
  EXPECT_NEAR(std::sqrt(covariance(4, 4)), 4.0, 0.05);
  EXPECT_NEAR(std::sqrt(covariance(2, 2)), 2.0, 0.02);

  samples = {drive.imu(0.0), drive.imu(0.01), drive.imu(0.21)};
  const ImuPrediction bridged = predict(odometry(0.0, drive.state(0.0)), samples, noise);
  EXPECT_FALSE(bridged.gap_start.has_value());
  EXPECT_LT((bridged.state.T_odom_body.p - drive.pose(0.21).p).norm(), 1e-2);
  // The force's mean over the gap is uncertain by q sqrt(dt / 3).
  const double velocity_sigma = std::sqrt(bridged.noise(6, 6));
  EXPECT_NEAR(velocity_sigma, 0.2 * 4.0 * std::sqrt(0.2 / 3.0), 0.02);
}

}  // namespace
}  // namespace fleetloc
