#include "shared/factors/reprojection_factor.hpp"

#include <gtest/gtest.h>

#include "test/unit/factors/factor_jacobian.hpp"

namespace fleetloc {
namespace {

RectifiedStereo some_stereo() {
  return {435.0, {370.0, 245.0}, 0.11, exp_se3(Vector6d(0.1, -0.2, 1.5, 0.02, -0.06, 0.01))};
}

struct Scene {
  Pose T_world_body = exp_se3(Vector6d(0.5, -0.4, 1.2, 3.0, -1.0, 2.0));
  Eigen::Vector3d p_cam0{0.7, -0.4, 3.0};
  Eigen::Vector3d p_world = T_world_body * (some_stereo().T_body_cam0 * p_cam0);
  StereoObservation observation;

  Scene() {
    const Eigen::Vector3d pixel = project(some_stereo(), p_cam0);
    observation.left = pixel.head<2>();
    observation.disparity = pixel(0) - pixel(2);
  }
  [[nodiscard]] std::vector<std::vector<double>> parameters(
      const Vector6d& move = Vector6d::Zero()) const {
    return {block_of(retract(T_world_body, move)), block_of(p_world)};
  }
};

const Vector6d kMove = Vector6d(0.02, -0.03, 0.01, 0.1, -0.05, 0.08);

TEST(StereoReprojectionFactor, JacobiansAreTheNumericOnes) {
  const Scene scene;
  const StereoReprojectionFactor factor(scene.observation, some_stereo(), {1.5});
  expect_numeric_jacobians(factor, scene.parameters());
  expect_numeric_jacobians(factor, scene.parameters(kMove));
}

TEST(MonoReprojectionFactor, JacobiansAreTheNumericOnes) {
  const Scene scene;
  const MonoReprojectionFactor factor(scene.observation, some_stereo(), {1.5});
  expect_numeric_jacobians(factor, scene.parameters());
  expect_numeric_jacobians(factor, scene.parameters(kMove));
}

TEST(StereoReprojectionFactor, IsPredictedMinusMeasuredInSigmas) {
  Scene scene;
  scene.observation.left += Eigen::Vector2d(1.0, -2.0);
  scene.observation.disparity += 4.0;
  const StereoReprojectionFactor stereo(scene.observation, some_stereo(), {2.0});
  const MonoReprojectionFactor mono(scene.observation, some_stereo(), {2.0});
  EXPECT_LT((residual_of(stereo, scene.parameters()) - Eigen::Vector3d(-0.5, 1.0, 1.5)).norm(),
            1e-10);
  EXPECT_LT((residual_of(mono, scene.parameters()) - Eigen::Vector2d(-0.5, 1.0)).norm(), 1e-10);
}

// Residuals at the current pose, Jacobians of pose and landmark at the first one.
template <typename Factor>
void expect_jacobians_at_first_estimate() {
  const Scene scene;
  const PoseParameters first = to_parameters(scene.T_world_body);
  const Factor with(scene.observation, some_stereo(), {1.0}, &first);
  const Factor without(scene.observation, some_stereo(), {1.0});
  EXPECT_EQ(residual_of(with, scene.parameters(kMove)),
            residual_of(without, scene.parameters(kMove)));
  const auto moved_jacobians = jacobians_of(with, scene.parameters(kMove));
  const auto first_jacobians = jacobians_of(without, scene.parameters());
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_LT((moved_jacobians[i] - first_jacobians[i]).norm(), 1e-9);
  }
}

TEST(StereoReprojectionFactor, TakesJacobiansAtTheFirstEstimate) {
  expect_jacobians_at_first_estimate<StereoReprojectionFactor>();
}

TEST(MonoReprojectionFactor, TakesJacobiansAtTheFirstEstimate) {
  expect_jacobians_at_first_estimate<MonoReprojectionFactor>();
}

TEST(StereoReprojectionFactor, GivesAPointBehindTheCameraALargeResidualWithoutGradient) {
  Scene scene;
  scene.p_world = scene.T_world_body * (some_stereo().T_body_cam0 * Eigen::Vector3d(0, 0, -1));
  const StereoReprojectionFactor factor(scene.observation, some_stereo(), {1.0});
  EXPECT_GT(residual_of(factor, scene.parameters()).norm(), 100.0);
  for (const Eigen::MatrixXd& J : jacobians_of(factor, scene.parameters())) {
    EXPECT_TRUE(J.isZero(0.0));
  }
}

}  // namespace
}  // namespace fleetloc
