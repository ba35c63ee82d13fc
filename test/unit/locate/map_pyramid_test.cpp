#include "cloud/locate/map_pyramid.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "test/unit/locate/street_map.hpp"

namespace fleetloc {
namespace {

TEST(MapPyramid, ValuesACellByTheNearestSurface) {
  const std::vector<MapPoint> points{
      {.p_map = {0.25F, 0.25F, 0.25F}, .normal = Eigen::Vector3f::UnitX()},
      {.p_map = {5.25F, 0.25F, 0.25F}, .normal = Eigen::Vector3f::UnitZ()}};
  MapInfo info;
  info.min = {0.25, 0.25, 0.25};
  info.max = {5.25, 0.25, 0.25};
  const LaserMap map(points, info);
  const MapPyramid pyramid(map, pyramid_config());
  EXPECT_EQ(pyramid.value(0, 0, 0), MapPyramid::kFull);
  EXPECT_EQ(pyramid.value(1, 0, 0), std::lround(MapPyramid::kFull * std::exp(-0.125)));
  EXPECT_EQ(pyramid.value(-1, -1, -1), std::lround(MapPyramid::kFull * std::exp(-0.375)));
  EXPECT_EQ(pyramid.value(2, 0, 0), 0);
  EXPECT_EQ(pyramid.value(10, 0, 0), 0) << "a level surface";
}

TEST(MapPyramid, KnowsTheLargestValueOfAWindowOfColumns) {
  const LaserMap map = StreetMap(3).map();
  const MapPyramid pyramid(map, pyramid_config());
  const Eigen::Vector3i& min = pyramid.min();
  const Eigen::Vector3i& max = pyramid.max();
  const auto column = [&](int x, int y) {
    std::uint8_t largest = 0;
    for (int z = min.z(); z < max.z(); ++z) largest = std::max(largest, pyramid.value(x, y, z));
    return largest;
  };
  for (int level = 0; level < pyramid.levels(); ++level) {
    const int size = 1 << level;
    for (int y = min.y() - size - 1; y <= max.y() + 1; y += 3) {
      for (int x = min.x() - size - 1; x <= max.x() + 1; x += 3) {
        std::uint8_t largest = 0;
        for (int j = 0; j < size; ++j) {
          for (int i = 0; i < size; ++i) largest = std::max(largest, column(x + i, y + j));
        }
        ASSERT_EQ(pyramid.largest(level, x, y), largest)
            << "level " << level << ", window " << x << ' ' << y;
      }
    }
  }
}

}  // namespace
}  // namespace fleetloc
