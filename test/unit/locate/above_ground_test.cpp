#include "cloud/locate/above_ground.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "shared/core/counter_random.hpp"

namespace fleetloc {
namespace {

constexpr GroundConfig kGroundConfig{
    .near_m = 12.0, .band_m = 0.4, .min_share = 0.15, .max_slope = 0.03};
constexpr double kCameraHeight = 0.9;  // [m]

/// A robot that drives up a ramp of 2 %, with walls to both sides.
struct Drive {
  std::vector<SeenLandmark> ground;
  std::vector<SeenLandmark> walls;

  explicit Drive(double ground_share) {
    const CounterRandom random(1, 1);
    const auto height = [](double x) { return 0.02 * x; };
    for (std::uint64_t i = 0; i < 300; ++i) {
      const double x = 20.0 * random.uniform(i, 0);
      const Eigen::Vector3d viewpoint(x, 0.0, height(x) + kCameraHeight);
      const double ahead = 2.0 + 8.0 * random.uniform(i, 1);
      SeenLandmark seen{.viewpoint = viewpoint};
      if (random.uniform(i, 2) < ground_share) {
        const double side = 3.0 * random.normal(i, 3);
        seen.p = {x + ahead, side, height(x + ahead) + 0.03 * random.normal(i, 4)};
        ground.push_back(seen);
      } else {
        const double up = 1.0 + 6.0 * random.uniform(i, 5);
        seen.p = {x + ahead, i % 2 == 0 ? 6.0 : -6.0, height(x + ahead) + up};
        walls.push_back(seen);
      }
    }
  }

  [[nodiscard]] std::vector<SeenLandmark> all() const {
    std::vector<SeenLandmark> all = ground;
    all.insert(all.end(), walls.begin(), walls.end());
    return all;
  }
};

TEST(AboveGround, LeavesOutTheGroundOfARampAndKeepsTheWalls) {
  const Drive drive(0.5);
  const auto height = camera_height(drive.all(), kGroundConfig);
  ASSERT_TRUE(height);
  EXPECT_NEAR(*height, kCameraHeight, 0.25);
  const auto kept = above_ground(drive.all(), kGroundConfig);
  const auto on_ground = std::ranges::count_if(
      kept, [](const SeenLandmark& seen) { return std::abs(seen.p.y()) != 6.0; });
  EXPECT_LE(on_ground, 5);
  EXPECT_GE(kept.size(), 9 * drive.walls.size() / 10);
}

TEST(AboveGround, KeepsAllIfNoGroundIsSeen) {
  const Drive drive(0.0);
  EXPECT_FALSE(camera_height(drive.all(), kGroundConfig));
  EXPECT_EQ(above_ground(drive.all(), kGroundConfig).size(), drive.walls.size());
  EXPECT_TRUE(above_ground({}, kGroundConfig).empty());
}

TEST(SpreadOut, KeepsTheFirstOfEachBlock) {
  std::vector<SeenLandmark> landmarks;
  for (int i = 0; i < 30; ++i) landmarks.push_back({.p = {0.1 * i - 1.05, 0.0, 0.5}});
  const auto kept = spread_out(landmarks, 1.0);
  ASSERT_EQ(kept.size(), 4U);
  for (const std::size_t first : {0U, 1U, 11U, 21U}) {
    const bool is_kept = std::ranges::any_of(
        kept, [&](const SeenLandmark& landmark) { return landmark.p == landmarks[first].p; });
    EXPECT_TRUE(is_kept) << first;
  }
  EXPECT_EQ(spread_out(landmarks, 0.05).size(), landmarks.size());
}

}  // namespace
}  // namespace fleetloc
