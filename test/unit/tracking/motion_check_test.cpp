#include "robot/tracking/motion_check.hpp"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "shared/geometry/so3.hpp"
#include "test/unit/tracking/tracking_config.hpp"

namespace fleetloc {
namespace {

const RectifiedStereo kStereo{
    .focal_px = 450.0, .center_px = {1024.0, 1024.0}, .baseline_m = 0.11, .T_body_cam0 = {}};

struct Scene {
  std::vector<Correspondence> correspondences;
  std::vector<bool> good;
};

/// Points between 1 and 8 m; the first of `outliers` of them are displaced by 5 to 20 px.
Scene scene(const Pose& T_current_previous, int points, int outliers, bool with_depth) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::normal_distribution<double> noise(0.0, 0.2);
  Scene result;
  for (int i = 0; i < points; ++i) {
    const double z = 4.5 + 3.5 * uniform(random);
    const Eigen::Vector3d p(0.7 * z * uniform(random), 0.45 * z * uniform(random), z);
    const Eigen::Vector3d previous = project(kStereo, p);
    const Eigen::Vector3d current = project(kStereo, T_current_previous * p);
    Correspondence c{.previous = previous.head<2>(), .current = current.head<2>()};
    c.current += Eigen::Vector2d(noise(random), noise(random));
    if (with_depth) c.disparity = previous[0] - previous[2] + noise(random);
    if (i < outliers) {
      const Eigen::Vector2d direction(uniform(random), uniform(random));
      c.current += direction.normalized() * (12.5 + 7.5 * uniform(random));
    }
    result.correspondences.push_back(c);
    result.good.push_back(i >= outliers);
  }
  return result;
}

int count(const std::vector<bool>& inliers, const std::vector<bool>& good, bool which) {
  int result = 0;
  for (std::size_t i = 0; i < good.size(); ++i) result += good[i] == which && inliers[i] ? 1 : 0;
  return result;
}

class MotionCheckTest : public testing::Test {
 protected:
  MotionCheckConfig config_ = default_tracking_config().motion;
  Pose T_{.R = exp_so3({0.02, -0.03, 0.01}), .p = {0.06, -0.02, -0.05}};
};

TEST_F(MotionCheckTest, FindsTheMotionDespiteManyOutliers) {
  const auto [correspondences, good] = scene(T_, 100, 40, true);
  const Pose prediction{.R = T_.R, .p = Eigen::Vector3d::Zero()};
  const auto motion = estimate_rigid_motion(correspondences, kStereo, prediction, config_);
  EXPECT_TRUE(motion.has_translation);
  EXPECT_GE(count(motion.inliers, good, true), 57);
  EXPECT_EQ(count(motion.inliers, good, false), 0);
  EXPECT_LT((motion.T_current_previous.p - T_.p).norm(), 0.006);
  EXPECT_LT(motion.T_current_previous.R.angularDistance(T_.R), 0.001);
}

TEST_F(MotionCheckTest, CorrectsAPredictedRotationThatIsWrong) {
  const auto [correspondences, good] = scene(T_, 100, 30, true);
  const Pose prediction{.R = T_.R * exp_so3({0.0, 0.06, 0.03}), .p = Eigen::Vector3d::Zero()};
  const auto motion = estimate_rigid_motion(correspondences, kStereo, prediction, config_);
  EXPECT_GE(count(motion.inliers, good, true), 66);
  EXPECT_EQ(count(motion.inliers, good, false), 0);
  EXPECT_LT(motion.T_current_previous.R.angularDistance(T_.R), 0.001);
}

TEST_F(MotionCheckTest, TakesStandstillAndPureRotation) {
  for (const Pose& T : {Pose{}, Pose{.R = exp_so3({0.0, 0.1, 0.0}), .p = {0, 0, 0}}}) {
    for (const bool with_depth : {true, false}) {
      const auto [correspondences, good] = scene(T, 100, 20, with_depth);
      const auto motion = estimate_rigid_motion(correspondences, kStereo, T, config_);
      EXPECT_EQ(motion.has_translation, with_depth);
      EXPECT_GE(count(motion.inliers, good, true), 76) << with_depth;
      EXPECT_LE(count(motion.inliers, good, false), with_depth ? 0 : 8);
    }
  }
}

TEST_F(MotionCheckTest, HoldsPointsWithoutDepthToTheirEpipolarLine) {
  auto [correspondences, good] = scene(T_, 120, 60, true);
  for (std::size_t i = 0; i < 80; ++i) correspondences[i].disparity = 0.0;  // 60 bad, 20 good
  const auto motion = estimate_rigid_motion(correspondences, kStereo, T_, config_);
  EXPECT_GE(count(motion.inliers, good, true), 57);
  EXPECT_LE(count(motion.inliers, good, false), 15);  // along the line they cannot be told apart
}

TEST_F(MotionCheckTest, WorksForOneCameraWithAKnownRotation) {
  const auto [correspondences, good] = scene(T_, 100, 30, false);
  const Pose prediction{.R = T_.R, .p = Eigen::Vector3d::Zero()};
  const auto motion = estimate_rigid_motion(correspondences, kStereo, prediction, config_);
  EXPECT_FALSE(motion.has_translation);
  EXPECT_GE(count(motion.inliers, good, true), 66);
  EXPECT_LE(count(motion.inliers, good, false), 10);
}

TEST_F(MotionCheckTest, TakesFewOrNoPoints) {
  for (const int points : {0, 1, 2, 3, 12, 13}) {
    for (const bool with_depth : {true, false}) {
      const auto [correspondences, good] = scene(T_, points, 0, with_depth);
      const auto motion = estimate_rigid_motion(correspondences, kStereo, T_, config_);
      EXPECT_EQ(motion.inliers.size(), static_cast<std::size_t>(points));
      EXPECT_EQ(count(motion.inliers, good, true), points) << points;
    }
  }
}

}  // namespace
}  // namespace fleetloc
