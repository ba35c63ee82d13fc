#include "robot/vio/triangulation.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace fleetloc {
namespace {

const RectifiedStereo kStereo{
    450.0,
    {370.0, 240.0},
    0.11,
    exp_se3((Vector6d() << 0.1, 1.2, -0.4, 0.02, -0.06, 0.01).finished())};
const Eigen::Vector3d kPoint(1.0, -0.5, 0.3);
constexpr TriangulationLimits kLimits{1.0, 50.0};

// Looks at the point from 4 m, `aside` from the line of view.
LandmarkView view(double aside, bool stereo) {
  const Pose T_odom_cam0{Eigen::Quaterniond::Identity(), kPoint - Eigen::Vector3d(aside, 0.2, 4.0)};
  LandmarkView result{T_odom_cam0 * inverse(kStereo.T_body_cam0), {}};
  const Eigen::Vector3d pixel = project(kStereo, inverse(T_odom_cam0) * kPoint);
  result.observation.left = pixel.head<2>();
  result.observation.disparity = stereo ? pixel(0) - pixel(2) : 0.0;
  return result;
}

TEST(Triangulation, FindsAPointFromOneStereoPair) {
  const std::vector<LandmarkView> views{view(0.3, true)};
  const auto p = triangulate(views, kStereo, kLimits);
  ASSERT_TRUE(p.has_value());
  EXPECT_LT((*p - kPoint).norm(), 1e-9);
}

TEST(Triangulation, FindsAPointFromTwoSightsOfOneCamera) {
  const std::vector<LandmarkView> views{view(0.0, false), view(0.4, false)};
  const auto p = triangulate(views, kStereo, kLimits);
  ASSERT_TRUE(p.has_value());
  EXPECT_LT((*p - kPoint).norm(), 1e-6);
}

TEST(Triangulation, RefinesOverAllSights) {
  std::vector<LandmarkView> views{view(0.0, true), view(0.5, false), view(-0.5, false)};
  views[0].observation.disparity += 1.0;  // half a metre too near
  const auto alone = triangulate(std::span(views).first(1), kStereo, kLimits);
  const auto all = triangulate(views, kStereo, kLimits);
  ASSERT_TRUE(alone.has_value() && all.has_value());
  EXPECT_LT((*all - kPoint).norm(), 0.2 * (*alone - kPoint).norm());
}

TEST(Triangulation, RefusesWhatIsTooWeak) {
  const std::vector<LandmarkView> one{view(0.0, false)};
  EXPECT_FALSE(triangulate(one, kStereo, kLimits).has_value());
  const std::vector<LandmarkView> no_parallax{view(0.0, false), view(0.001, false)};
  EXPECT_FALSE(triangulate(no_parallax, kStereo, kLimits).has_value());
  const std::vector<LandmarkView> far{view(0.3, true)};
  EXPECT_FALSE(triangulate(far, kStereo, {1.0, 3.0}).has_value());
}

}  // namespace
}  // namespace fleetloc
