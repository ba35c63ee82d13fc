#include "cloud/locate/free_space.hpp"

#include <gtest/gtest.h>

namespace fleetloc {
namespace {

const FreeSpace::Config kFreeSpaceConfig{
    .margin_m = 0.5, .min_planarity = 0.6, .min_incidence = 0.3, .reach_m = 0.15};

/// A yard with a level ground, and what a test puts up there.
class FreeSpaceTest : public testing::Test {
 protected:
  FreeSpaceTest() {
    for (double x = -10.0; x <= 10.0; x += 0.1) {
      for (double y = -10.0; y <= 10.0; y += 0.1) add({x, y, 0.0}, {0.0, 0.0, 1.0}, 1.0F);
    }
  }

  /// Across the x axis at `x`, from y to y, up to 3 m.
  void add_wall(double x, double y_from, double y_to, float planarity = 1.0F) {
    for (double y = y_from; y <= y_to; y += 0.1) {
      for (double z = 0.0; z <= 3.0; z += 0.1) add({x, y, z}, {1.0, 0.0, 0.0}, planarity);
    }
  }

  [[nodiscard]] bool is_blocked(const Eigen::Vector3d& viewpoint,
                                const Eigen::Vector3d& landmark,
                                double sigma_m = 0.01) const {
    const MapInfo info{
        .frame = "map", .resolution_m = 0.1, .min = {-10.0, -10.0, 0.0}, .max = {10.0, 10.0, 3.0}};
    const LaserMap map(points_, info);
    const MapPyramid pyramid(map, {.cell_m = 0.5, .levels = 4, .level_from = 0.9});
    return FreeSpace(map, pyramid, kFreeSpaceConfig).is_blocked(viewpoint, landmark, sigma_m);
  }

 private:
  void add(const Eigen::Vector3d& p, const Eigen::Vector3d& normal, float planarity) {
    points_.push_back(
        {.p_map = p.cast<float>(), .normal = normal.cast<float>(), .planarity = planarity});
  }

  std::vector<MapPoint> points_;
};

TEST_F(FreeSpaceTest, IsWhereTheMapHasNothing) {
  EXPECT_FALSE(is_blocked({-5.0, 0.0, 1.0}, {5.0, 1.0, 1.5}));
}

TEST_F(FreeSpaceTest, EndsAtAWall) {
  add_wall(0.0, -5.0, 5.0);
  EXPECT_TRUE(is_blocked({-5.0, 0.0, 1.0}, {5.0, 1.0, 1.5}));
  EXPECT_TRUE(is_blocked({5.0, 1.0, 1.5}, {-5.0, 0.0, 1.0})) << "from its other side";
}

TEST_F(FreeSpaceTest, LeadsToWhatIsOnAWall) {
  add_wall(0.0, -5.0, 5.0);
  EXPECT_FALSE(is_blocked({-5.0, 0.0, 1.0}, {0.0, 0.5, 1.2}));
  EXPECT_FALSE(is_blocked({-5.0, 0.0, 1.0}, {0.3, 0.5, 1.2})) << "that is measured a little behind";
  EXPECT_FALSE(is_blocked({-5.0, 0.0, 1.0}, {1.0, 0.5, 1.2}, 0.5)) << "or not measured well";
  EXPECT_TRUE(is_blocked({-5.0, 0.0, 1.0}, {1.0, 0.5, 1.2}));
}

TEST_F(FreeSpaceTest, LeadsThroughADoor) {
  add_wall(0.0, -5.0, -0.6);
  add_wall(0.0, 0.6, 5.0);
  EXPECT_FALSE(is_blocked({-5.0, 0.0, 1.0}, {5.0, 0.0, 1.0}));
  EXPECT_TRUE(is_blocked({-5.0, 1.0, 1.0}, {5.0, 1.0, 1.0})) << "not beside it";
}

TEST_F(FreeSpaceTest, LeadsAboveAWallAndThroughLeaves) {
  add_wall(0.0, -5.0, 5.0);
  EXPECT_FALSE(is_blocked({-5.0, 0.0, 3.6}, {5.0, 0.0, 3.6}));
  add_wall(3.0, -5.0, 5.0, 0.2F);
  EXPECT_FALSE(is_blocked({1.0, 0.0, 1.0}, {8.0, 0.0, 1.0}));
}

TEST_F(FreeSpaceTest, IsAlongAWall) {
  add_wall(0.0, -5.0, 5.0);
  EXPECT_FALSE(is_blocked({-0.3, -4.0, 1.0}, {0.1, 4.0, 1.0}));
}

}  // namespace
}  // namespace fleetloc
