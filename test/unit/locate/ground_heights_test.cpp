#include "cloud/locate/ground_heights.hpp"

#include <gtest/gtest.h>

namespace fleetloc {
namespace {

constexpr double kLevelFrom = 0.9;

class GroundHeightsTest : public testing::Test {
 protected:
  void add_level(double x_from, double x_to, double y_from, double y_to, double z) {
    for (double x = x_from; x < x_to; x += 0.5) {
      for (double y = y_from; y < y_to; y += 0.5) add({x, y, z}, Eigen::Vector3f::UnitZ());
    }
  }
  void add(const Eigen::Vector3d& p_map, const Eigen::Vector3f& normal) {
    points_.push_back({.p_map = p_map.cast<float>(), .normal = normal});
  }
  [[nodiscard]] GroundHeights heights() const {
    MapInfo info;
    info.max = {40.0, 40.0, 10.0};
    return {LaserMap(points_, info), kLevelFrom};
  }

  std::vector<MapPoint> points_;
};

TEST_F(GroundHeightsTest, AreThoseOfTheLowestLevelSurface) {
  add_level(0.0, 40.0, 0.0, 40.0, 1.0);
  add_level(10.0, 14.0, 10.0, 14.0, 5.0);  // a roof with ground below it
  add({20.0, 20.0, -3.0}, Eigen::Vector3f::UnitX());
  const GroundHeights ground = heights();
  for (double x = 0.0; x <= 40.0; x += 3.7) {
    EXPECT_FLOAT_EQ(static_cast<float>(ground.at(x, 12.0)), 1.0F) << x;
  }
}

TEST_F(GroundHeightsTest, HaveARangeBetweenTwoCorners) {
  add_level(0.0, 20.0, 0.0, 40.0, 1.0);
  add_level(20.0, 40.0, 0.0, 40.0, 3.0);
  const GroundHeights ground = heights();
  const auto expect_range = [&](double x_from, double x_to, double lowest, double highest) {
    const auto range = ground.range({x_from, 5.0}, {x_to, 30.0});
    EXPECT_NEAR(range.lowest_m, lowest, 1e-6);
    EXPECT_NEAR(range.highest_m, highest, 1e-6);
  };
  expect_range(2.0, 12.0, 1.0, 1.0);
  expect_range(30.0, 38.0, 3.0, 3.0);
  expect_range(2.0, 38.0, 1.0, 3.0);
  expect_range(-1e9, 1e9, 1.0, 3.0);
}

TEST_F(GroundHeightsTest, LookPastARoofThatHidesTheGround) {
  add_level(0.0, 16.0, 0.0, 40.0, 1.0);
  add_level(16.0, 20.0, 0.0, 40.0, 6.0);
  add_level(20.0, 40.0, 0.0, 40.0, 1.0);
  EXPECT_FLOAT_EQ(static_cast<float>(heights().at(18.0, 20.0)), 1.0F);
}

TEST_F(GroundHeightsTest, FillGapsFromTheNearestGround) {
  add_level(0.0, 8.0, 0.0, 40.0, 1.0);
  add_level(32.0, 40.0, 0.0, 40.0, 3.0);
  const GroundHeights ground = heights();
  EXPECT_FLOAT_EQ(static_cast<float>(ground.at(15.0, 20.0)), 1.0F);
  EXPECT_FLOAT_EQ(static_cast<float>(ground.at(25.0, 20.0)), 3.0F);
  EXPECT_FLOAT_EQ(static_cast<float>(ground.at(-50.0, 20.0)), 1.0F) << "beyond the map";
}

TEST_F(GroundHeightsTest, AreZeroWhereNothingIsLevel) {
  add({20.0, 20.0, 4.0}, Eigen::Vector3f::UnitX());
  EXPECT_EQ(heights().at(20.0, 20.0), 0.0);
}

}  // namespace
}  // namespace fleetloc
