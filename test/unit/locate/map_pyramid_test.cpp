#include "cloud/locate/map_pyramid.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "test/unit/locate/street_map.hpp"

namespace fleetloc {
namespace {

TEST(MapPyramid, ValuesACellByTheNearestSurface) {
  const std::vector<MapPoint> points{
      {.p_map = {0.25F, 0.25F, 0.25F}, .normal = Eigen::Vector3f::UnitX()},
      {.p_map = {5.25F, 0.25F, 0.0F}, .normal = Eigen::Vector3f::UnitZ()}};
  MapInfo info;
  info.min = {0.25, 0.25, 0.0};
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
  // Of a slab, or of any height.
  const auto column = [&](int slab, int x, int y) {
    std::uint8_t largest = 0;
    for (int z = min.z(); z < max.z(); ++z) {
      const bool is_in = slab == pyramid.any_height() || pyramid.slab_of(z - 1) == slab ||
                         pyramid.slab_of(z) == slab || pyramid.slab_of(z + 1) == slab;
      if (is_in) largest = std::max(largest, pyramid.value(x, y, z));
    }
    return largest;
  };
  for (const int slab : {0, 1, pyramid.any_height()}) {
    for (int level = 0; level < pyramid.levels(); ++level) {
      const int size = 1 << level;
      for (int y = min.y() - size - 1; y <= max.y() + 1; y += 3) {
        for (int x = min.x() - size - 1; x <= max.x() + 1; x += 3) {
          std::uint8_t largest = 0;
          for (int j = 0; j < size; ++j) {
            for (int i = 0; i < size; ++i) {
              largest = std::max(largest, column(slab, x + i, y + j));
            }
          }
          ASSERT_EQ(pyramid.windows(level, slab).largest(x, y), largest)
              << "level " << level << ", slab " << slab << ", window " << x << ' ' << y;
        }
      }
    }
  }
}

TEST(MapPyramid, KnowsTheLargestValueOfFourWindows) {
  const LaserMap map = StreetMap(3).map();
  const MapPyramid pyramid(map, pyramid_config());
  const Eigen::Vector3i& min = pyramid.min();
  const Eigen::Vector3i& max = pyramid.max();
  const MapPyramid::Windows& windows = pyramid.windows(2, pyramid.any_height());
  for (int y = min.y() - 8; y <= max.y() + 2; y += 5) {
    for (int x = min.x() - 8; x <= max.x() + 2; x += 3) {
      for (const Eigen::Vector2i& d : {Eigen::Vector2i(0, 0), {0, 3}, {4, 0}, {3, 4}, {1000, 9}}) {
        const int largest = std::max({windows.largest(x, y),
                                      windows.largest(x + d.x(), y),
                                      windows.largest(x, y + d.y()),
                                      windows.largest(x + d.x(), y + d.y())});
        ASSERT_EQ(windows.largest(x, y, d.x(), d.y()), largest) << x << ' ' << y;
      }
    }
  }
}

TEST(MapPyramid, MeasuresHeightsFromTheGround) {
  std::vector<MapPoint> points;
  const auto ground = [](double x) { return 0.1 * x; };
  for (double x = 0.0; x <= 60.0; x += 0.5) {
    for (double y = 0.0; y <= 20.0; y += 0.5) {
      points.push_back({.p_map = Eigen::Vector3d(x, y, ground(x)).cast<float>(),
                        .normal = Eigen::Vector3f(-0.1F, 0.0F, 1.0F).normalized()});
    }
    points.push_back({.p_map = Eigen::Vector3d(x, 5.25, ground(x) + 3.25).cast<float>(),
                      .normal = Eigen::Vector3f::UnitY()});
  }
  MapInfo info;
  info.max = {60.0, 20.0, 9.25};
  const MapPyramid pyramid(LaserMap(points, info), pyramid_config());
  for (int x = 10; x < 110; ++x) {  // half metres; the ground is the lowest within some metres
    const int nearest =
        std::max({pyramid.value(x, 10, 6), pyramid.value(x, 10, 7), pyramid.value(x, 10, 8)});
    EXPECT_EQ(nearest, MapPyramid::kFull) << x;
  }
  EXPECT_LE(pyramid.max().z(), 12);
}

}  // namespace
}  // namespace fleetloc
