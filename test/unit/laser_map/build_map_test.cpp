#include "cloud/laser_map/build_map.hpp"

#include <cmath>
#include <limits>
#include <random>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "deploy/config/default_config.hpp"

namespace fleetloc {
namespace {

MapConfig default_map_config() {
  return read_map_config(ConfigReader::from_string(default_config("map")).section("map"));
}

/// Points of the square |x|, |y| < 1 m rotated by R, with noise along its normal.
std::vector<Eigen::Vector3f> noisy_square(const Eigen::Quaterniond& R, double sigma_m) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::normal_distribution<double> noise(0.0, sigma_m);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Vector3d p(uniform(random), uniform(random), noise(random));
    points.emplace_back((R * p).cast<float>());
  }
  return points;
}

TEST(BuildMap, FindsTheNormalOfATiltedPlane) {
  const Eigen::Quaterniond R(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, -0.5).normalized()));
  const Eigen::Vector3f normal = (R * Eigen::Vector3d::UnitZ()).cast<float>();
  const LaserMap map = build_map(noisy_square(R, 0.003), "map", default_map_config());
  ASSERT_GT(map.size(), 1000U);
  for (const MapPoint& point : map.points()) {
    EXPECT_NEAR(point.normal.norm(), 1.0F, 1e-5F);
    EXPECT_GT(std::abs(point.normal.dot(normal)), std::cos(0.05F));
    EXPECT_GT(point.planarity, 0.9F);
  }
  EXPECT_EQ(planar_share(map, 0.9), 1.0);
}

TEST(BuildMap, FindsNormalsInCoarserVoxelsToo) {
  const MapConfig coarse = at_resolution(default_map_config(), 0.2);
  const LaserMap map =
      build_map(noisy_square(Eigen::Quaterniond::Identity(), 0.003), "map", coarse);
  EXPECT_LT(map.size(), 300U);
  EXPECT_EQ(map.info().resolution_m, 0.2);
  EXPECT_EQ(planar_share(map, 0.9), 1.0);
}

TEST(BuildMap, HasPlanarityOneOnAPerfectPlane) {
  const LaserMap map =
      build_map(noisy_square(Eigen::Quaterniond::Identity(), 0.0), "map", default_map_config());
  for (const MapPoint& point : map.points()) EXPECT_GT(point.planarity, 0.9999F);
}

TEST(BuildMap, HasLowPlanarityInAVolumeAndOnALine) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(-0.5F, 0.5F);
  std::vector<Eigen::Vector3f> volume;
  volume.reserve(20000);
  for (int i = 0; i < 20000; ++i) {
    volume.emplace_back(uniform(random), uniform(random), uniform(random));
  }
  const LaserMap filled = build_map(volume, "map", default_map_config());
  EXPECT_LT(planar_share(filled, 0.6), 0.02);

  std::vector<Eigen::Vector3f> line;
  line.reserve(1000);
  for (int i = 0; i < 1000; ++i) line.emplace_back(0.001F * static_cast<float>(i), 0.0F, 0.0F);
  const LaserMap wire = build_map(line, "map", default_map_config());
  for (const MapPoint& point : wire.points()) EXPECT_EQ(point.planarity, 0.0F);
}

TEST(BuildMap, LeavesASparsePointWithoutNormal) {
  const LaserMap map =
      build_map({{0.0F, 0.0F, 0.0F}, {5.0F, 0.0F, 0.0F}}, "map", default_map_config());
  ASSERT_EQ(map.size(), 2U);
  EXPECT_EQ(map.point(0).normal, Eigen::Vector3f::Zero());
  EXPECT_EQ(map.point(0).planarity, 0.0F);
}

TEST(BuildMap, KeepsTheMeanOfEachVoxel) {
  MapConfig config = default_map_config();
  config.resolution_m = 1.0;
  const LaserMap map =
      build_map({{0.1F, 0.1F, 0.1F}, {-0.1F, 0.1F, 0.1F}, {0.3F, 0.5F, 0.1F}}, "room", config);
  ASSERT_EQ(map.size(), 2U);  // voxels in the order of their coordinates
  EXPECT_EQ(map.point(0).p_map, Eigen::Vector3f(-0.1F, 0.1F, 0.1F));
  EXPECT_TRUE(map.point(1).p_map.isApprox(Eigen::Vector3f(0.2F, 0.3F, 0.1F)));
  EXPECT_EQ(map.info().frame, "room");
  EXPECT_EQ(map.info().resolution_m, 1.0);
  EXPECT_FLOAT_EQ(static_cast<float>(map.info().min.x()), -0.1F);
  EXPECT_FLOAT_EQ(static_cast<float>(map.info().max.y()), 0.3F);
}

TEST(BuildMap, IsTheSameWhenBuiltTwice) {
  const auto points = noisy_square(Eigen::Quaterniond::Identity(), 0.01);
  const auto config = default_map_config();
  EXPECT_EQ(build_map(points, "map", config).info().hash,
            build_map(points, "map", config).info().hash);
}

TEST(BuildMap, IsTheSameWithAnyNumberOfThreads) {
  const auto points = noisy_square(Eigen::Quaterniond::Identity(), 0.01);
  MapConfig config = default_map_config();
  config.threads = 1;
  const MapHash alone = build_map(points, "map", config).info().hash;
  config.threads = 3;
  EXPECT_EQ(build_map(points, "map", config).info().hash, alone);
}

TEST(BuildMap, LeavesOutPointsThatAreNotFinite) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto config = default_map_config();
  EXPECT_EQ(build_map({{0.0F, 0.0F, 0.0F}, {nan, 0.0F, 0.0F}}, "map", config).size(), 1U);
  EXPECT_THROW(build_map({{nan, 0.0F, 0.0F}}, "map", config), MapBuildError);
}

TEST(BuildMap, RefusesCoordinatesThatAFloatDoesNotResolve) {
  EXPECT_THROW(build_map({{500000.0F, 0.0F, 0.0F}}, "map", default_map_config()), MapBuildError);
}

TEST(BuildMap, ReportsItsProgressUpToTheEnd) {
  std::size_t last = 0;
  const LaserMap map = build_map(noisy_square(Eigen::Quaterniond::Identity(), 0.01),
                                 "map",
                                 default_map_config(),
                                 [&](std::size_t done, std::size_t) { last = done; });
  EXPECT_EQ(last, map.size());
}

TEST(BuildMap, MayLeaveARectangleOutAtAnyHeight) {
  const std::vector<Eigen::Vector3f> points = {
      {0.0F, 0.0F, 0.0F}, {1.5F, 2.5F, 90.0F}, {1.5F, 4.5F, 0.0F}, {2.5F, 2.5F, -3.0F}};
  const auto kept = points_outside(points, {.min = {1.0, 2.0}, .max = {2.0, 3.0}});
  EXPECT_THAT(kept, testing::ElementsAre(points[0], points[2], points[3]));
}

}  // namespace
}  // namespace fleetloc
