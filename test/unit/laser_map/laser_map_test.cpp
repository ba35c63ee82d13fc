#include "cloud/laser_map/laser_map.hpp"

#include <cmath>
#include <limits>
#include <random>
#include <utility>

#include <gtest/gtest.h>

namespace fleetloc {
namespace {

LaserMap map_of(const std::vector<Eigen::Vector3f>& positions) {
  std::vector<MapPoint> points;
  points.reserve(positions.size());
  for (const Eigen::Vector3f& p_map : positions) points.push_back({.p_map = p_map});
  return LaserMap(std::move(points), {.frame = "map", .resolution_m = 0.1});
}

TEST(LaserMap, FindsTheSameNearestPointAsAnExhaustiveSearch) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(-5.0F, 5.0F);
  const auto draw = [&] {
    return Eigen::Vector3f(uniform(random), uniform(random), uniform(random));
  };
  std::vector<Eigen::Vector3f> positions(2000);
  for (Eigen::Vector3f& p_map : positions) p_map = draw();
  const LaserMap map = map_of(positions);

  for (int query = 0; query < 500; ++query) {
    const Eigen::Vector3d p_map = draw().cast<double>();
    std::size_t expected = 0;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const double distance = (positions[i].cast<double>() - p_map).squaredNorm();
      if (distance < (positions[expected].cast<double>() - p_map).squaredNorm()) expected = i;
    }
    const auto found = map.nearest(p_map, 20.0);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->index, expected);
    EXPECT_NEAR(
        found->squared_distance, (positions[expected].cast<double>() - p_map).squaredNorm(), 1e-12);
  }
}

TEST(LaserMap, TakesTheLeastIndexOfPointsAtOneDistance) {
  std::vector<Eigen::Vector3f> corners;  // more than fit one leaf of the tree
  for (int repeat = 0; repeat < 10; ++repeat) {
    for (const float x : {1.0F, -1.0F}) {
      for (const float y : {1.0F, -1.0F}) {
        for (const float z : {1.0F, -1.0F}) corners.emplace_back(x, y, z);
      }
    }
  }
  const auto found = map_of(corners).nearest(Eigen::Vector3d::Zero(), 2.0);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->index, 0U);
}

TEST(LaserMap, FindsNothingBeyondTheRadius) {
  const LaserMap map = map_of({{1.0F, 0.0F, 0.0F}});
  EXPECT_FALSE(map.nearest(Eigen::Vector3d::Zero(), 0.999));
  EXPECT_TRUE(map.nearest(Eigen::Vector3d::Zero(), 1.0));
}

TEST(LaserMap, FindsNothingForAPointThatIsNotFinite) {
  const LaserMap map = map_of({{1.0F, 0.0F, 0.0F}});
  EXPECT_FALSE(map.nearest(Eigen::Vector3d(0.0, std::nan(""), 0.0), 10.0));
  EXPECT_FALSE(map.nearest(Eigen::Vector3d(0.0, 0.0, HUGE_VAL), 10.0));
}

TEST(LaserMap, MayBeEmpty) {
  EXPECT_FALSE(map_of({}).nearest(Eigen::Vector3d::Zero(), 10.0));
}

TEST(LaserMap, FindsPointsAfterItWasMoved) {
  LaserMap first = map_of({{1.0F, 0.0F, 0.0F}, {2.0F, 0.0F, 0.0F}});
  const LaserMap second = std::move(first);
  EXPECT_EQ(second.nearest({2.1, 0.0, 0.0}, 1.0)->index, 1U);
}

}  // namespace
}  // namespace fleetloc
