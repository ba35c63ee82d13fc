#include "cloud/laser_map/map_hash.hpp"

#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace fleetloc {
namespace {

TEST(MapHash, IsTheOffsetBasisOfFnv1aForNoPoints) {
  EXPECT_EQ(to_string(map_hash({})), "6c62272e07bb014262b821756295c58d");
}

// Computed independently, with integers of arbitrary size.
TEST(MapHash, IsFnv1aOfThePointsBytes) {
  const std::vector<MapPoint> points = {
      {.p_map = {1.0F, -2.5F, 1e-3F}, .normal = {0.0F, 0.6F, -0.8F}, .planarity = 0.75F},
      {.p_map = {100.0F, 0.0F, 3.25F}, .normal = {1.0F, 0.0F, 0.0F}, .planarity = 1.0F}};
  EXPECT_EQ(to_string(map_hash(points)), "1f2c5491a5d6201330a60b6e86d7725a");
}

TEST(MapHash, ChangesWithASingleBitAndWithTheOrder) {
  std::vector<MapPoint> points(3);
  points[1].p_map.x() = 1.0F;
  const MapHash before = map_hash(points);
  std::swap(points[0], points[1]);
  EXPECT_NE(map_hash(points), before);
  std::swap(points[0], points[1]);
  points[2].planarity = -0.0F;
  EXPECT_NE(map_hash(points), before);
}

}  // namespace
}  // namespace fleetloc
