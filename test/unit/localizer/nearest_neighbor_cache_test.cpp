#include "cloud/localizer/nearest_neighbor_cache.hpp"

#include <cmath>
#include <cstdlib>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace fleetloc {
namespace {

constexpr int kLandmarks = 200;

/// A rough floor of 4 m x 4 m, points every 0.1 m, some of them twice.
LaserMap floor_map() {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> rough(-0.02F, 0.02F);
  std::vector<MapPoint> points;
  for (int i = 0; i < 1600; ++i) {
    const std::div_t place = std::div(i, 40);
    MapPoint point;
    point.p_map = {0.1F * static_cast<float>(place.rem) + rough(random),
                   0.1F * static_cast<float>(place.quot) + rough(random),
                   rough(random)};
    points.push_back(point);
    if (i % 10 == 0) points.push_back(point);
  }
  return LaserMap(std::move(points), {.frame = "map", .resolution_m = 0.1});
}

/// Landmarks walk in steps of `step_m` around and beyond the floor, searched within changing
/// radii. Returns the searches that the memory made, per call, and compares every result.
double share_searched(double step_m) {
  const LaserMap map = floor_map();
  NearestNeighborCache memory(map);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-0.5, 4.5);
  std::uniform_real_distribution<double> height(-0.5, 0.5);
  std::normal_distribution<double> step(0.0, step_m);
  std::uniform_real_distribution<double> radius(0.05, 0.6);

  std::vector<Eigen::Vector3d> landmarks(kLandmarks);
  for (Eigen::Vector3d& p_map : landmarks) {
    p_map = {place(random), place(random), height(random)};
  }
  std::size_t calls = 0;
  for (int round = 0; round < 50; ++round) {
    const double radius_m = radius(random);
    for (unsigned i = 0; i < kLandmarks; ++i) {
      landmarks[i] += Eigen::Vector3d(step(random), step(random), step(random));
      const auto expected = map.nearest(landmarks[i], radius_m);
      const auto found = memory.nearest(LandmarkId{i}, landmarks[i], radius_m);
      ++calls;
      EXPECT_EQ(found.has_value(), expected.has_value());
      if (!found || !expected) continue;
      EXPECT_EQ(found->index, expected->index);
      EXPECT_EQ(found->squared_distance, expected->squared_distance);
    }
  }
  return static_cast<double>(memory.searches()) / static_cast<double>(calls);
}

TEST(NearestNeighborCache, FindsWhatASearchFindsAndSeldomSearchesForLandmarksThatHardlyMove) {
  EXPECT_LT(share_searched(0.001), 0.4);
}

TEST(NearestNeighborCache, FindsWhatASearchFindsWhereverLandmarksGo) {
  EXPECT_GT(share_searched(0.1), 0.5);
  share_searched(0.01);
}

TEST(NearestNeighborCache, ForgetsWhatItIsTold) {
  const LaserMap map = floor_map();
  NearestNeighborCache memory(map);
  const std::size_t empty = memory.memory_bytes();
  memory.nearest(LandmarkId{1}, {1.52, 1.03, 0.1}, 0.5);
  memory.nearest(LandmarkId{2}, {1.52, 1.03, 0.1}, 0.5);
  memory.forget([](LandmarkId landmark) { return landmark == LandmarkId{1}; });
  memory.nearest(LandmarkId{2}, {1.52, 1.03, 0.1}, 0.5);
  EXPECT_EQ(memory.searches(), 2U);
  memory.nearest(LandmarkId{1}, {1.52, 1.03, 0.1}, 0.5);
  EXPECT_EQ(memory.searches(), 3U);
  memory.forget([](LandmarkId /*landmark*/) { return true; });
  EXPECT_EQ(memory.memory_bytes(), empty);
}

TEST(NearestNeighborCache, KnowsNothingOfPointsThatAreNotFinite) {
  const LaserMap map = floor_map();
  NearestNeighborCache memory(map);
  const Eigen::Vector3d p_map(1.52, 1.03, 0.1);
  EXPECT_TRUE(memory.nearest(LandmarkId{1}, p_map, 0.5));
  EXPECT_FALSE(memory.nearest(LandmarkId{1}, {1.0, HUGE_VAL, 0.1}, 0.5));
  EXPECT_FALSE(memory.nearest(LandmarkId{1}, {1.0, std::nan(""), 0.1}, 0.5));
  EXPECT_TRUE(memory.nearest(LandmarkId{1}, p_map, 0.5));
}

}  // namespace
}  // namespace fleetloc
