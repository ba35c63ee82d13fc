#include "deploy/evaluation/errors/trajectory_error.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

TEST(Statistics, AgreeWithTheirDefinitions) {
  const Statistics odd = statistics({4.0, 1.0, 1.0});
  EXPECT_DOUBLE_EQ(odd.median, 1.0);
  EXPECT_DOUBLE_EQ(odd.mean, 2.0);
  EXPECT_DOUBLE_EQ(odd.rmse, std::sqrt(6.0));
  EXPECT_DOUBLE_EQ(odd.std, std::sqrt(2.0));
  EXPECT_DOUBLE_EQ(odd.max, 4.0);
  EXPECT_DOUBLE_EQ(statistics({4.0, 1.0, 3.0, 2.0}).median, 2.5);
  EXPECT_EQ(statistics({}).max, 0.0);
}

TEST(TrajectoryError, IsTheDistanceAndTheAngleOfEachPair) {
  const Pose T_truth_estimate{.R = exp_so3({0.0, 0.0, 1.0}), .p = {1.0, 2.0, 3.0}};
  std::vector<PosePair> pairs;
  for (const double size : {1.0, 2.0, 6.0}) {
    const Pose T_truth_body{.R = exp_so3({size, 0.1, 0.0}), .p = {size, 0.0, 1.0}};
    Pose wrong = T_truth_body;
    wrong.p += size * Eigen::Vector3d(0.0, 0.6, -0.8);
    wrong.R = wrong.R * exp_so3(size * std::numbers::pi / 180.0 * Eigen::Vector3d(0.0, 0.8, 0.6));
    pairs.push_back({.stamp = {},
                     .T_truth_body = T_truth_body,
                     .T_estimate_body = inverse(T_truth_estimate) * wrong});
  }
  const TrajectoryError error = absolute_trajectory_error(pairs, T_truth_estimate);
  EXPECT_EQ(error.poses, 3U);
  EXPECT_NEAR(error.translation_m.median, 2.0, 1e-12);
  EXPECT_NEAR(error.translation_m.mean, 3.0, 1e-12);
  EXPECT_NEAR(error.translation_m.max, 6.0, 1e-12);
  EXPECT_NEAR(error.rotation_deg.median, 2.0, 1e-9);
  EXPECT_NEAR(error.rotation_deg.rmse, std::sqrt(41.0 / 3.0), 1e-9);
}

// An odometry that goes 2 % too far and turns too fast about z, in a frame of its own.
TEST(RelativeTrajectoryError, IsTheErrorOfEachMotionInWhateverFrame) {
  constexpr double kTurn = 0.001;  // [rad/s]
  const Pose T_estimate_truth{.R = exp_so3({0.3, 0.0, 1.0}), .p = {1.0, 2.0, 3.0}};
  std::vector<PosePair> pairs;
  for (int i = 0; i <= 150; ++i) {
    const double t = 0.1 * i;
    const Pose wrong{.R = exp_so3({0.0, 0.0, kTurn * t}), .p = {0.0, 0.0, 1.02 * t}};
    pairs.push_back({.stamp = Timestamp(std::chrono::milliseconds(100 * i)),
                     .T_truth_body = {.p = {0.0, 0.0, t}},
                     .T_estimate_body = T_estimate_truth * wrong});
  }
  const auto error =
      relative_trajectory_error(pairs, std::chrono::seconds(10), std::chrono::milliseconds(50));
  EXPECT_EQ(error.poses, 51U);
  EXPECT_NEAR(error.translation_m.rmse, 0.2, 1e-9);
  EXPECT_NEAR(error.translation_m.max, 0.2, 1e-9);
  EXPECT_NEAR(error.rotation_deg.rmse, 0.01 * 180.0 / std::numbers::pi, 1e-9);
}

TEST(RelativeTrajectoryError, TakesTheNearestPoseWithinTheTolerance) {
  std::vector<PosePair> pairs(4);
  for (PosePair& pair : pairs) pair.T_truth_body = pair.T_estimate_body = {};
  constexpr std::array kMilliseconds{0, 9900, 10040, 21000};
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    pairs[i].stamp = Timestamp(std::chrono::milliseconds(kMilliseconds[i]));
    pairs[i].T_estimate_body.p.x() = static_cast<double>(i);
  }
  const auto relative = [&](int tolerance_ms) {
    return relative_trajectory_error(
        pairs, std::chrono::seconds(10), std::chrono::milliseconds(tolerance_ms));
  };
  EXPECT_EQ(relative(100).poses, 1U);
  EXPECT_NEAR(relative(100).translation_m.max, 2.0, 1e-12);
  EXPECT_EQ(relative(10).poses, 0U);
}

TEST(Nees, IsTheMeanSquareOfErrorsInSigmas) {
  Vector6d sigmas;
  sigmas << 0.01, 0.02, 0.03, 0.1, 0.2, 0.3;
  const Pose T_ref_estimate{.R = exp_so3({0.3, -1.0, 2.0}), .p = {4.0, 5.0, 6.0}};
  const Pose T_ref_truth = retract(T_ref_estimate, 2.0 * sigmas);
  const Matrix6d covariance = sigmas.cwiseAbs2().asDiagonal();
  const auto nees = nees_per_degree_of_freedom(T_ref_truth, T_ref_estimate, covariance);
  ASSERT_TRUE(nees);
  EXPECT_NEAR(*nees, 4.0, 1e-9);
}

TEST(Nees, DoesNotExistForACovarianceThatIsNotPositiveDefinite) {
  EXPECT_FALSE(nees_per_degree_of_freedom({}, {}, Matrix6d::Zero()));
  EXPECT_FALSE(nees_per_degree_of_freedom({}, {}, Matrix6d::Constant(std::nan(""))));
}

}  // namespace
}  // namespace fleetloc
