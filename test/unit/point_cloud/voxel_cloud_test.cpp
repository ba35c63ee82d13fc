#include "cloud/point_cloud/voxel_cloud.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "cloud/point_cloud/point_cloud_file.hpp"
#include "shared/core/counter_random.hpp"
#include "test/test_folder.hpp"

namespace fleetloc {
namespace {

/// On a wall of 10 m by 10 m.
Eigen::Vector3d point(std::uint64_t i) {
  const CounterRandom random(1, 0);
  return {10.0 * random.uniform(i, 0) - 5.0, 0.03, 10.0 * random.uniform(i, 1) - 5.0};
}

TEST(VoxelCloud, KeepsTheMeanOfEachVoxel) {
  VoxelCloud cloud(0.5, 1000);
  cloud.add({-0.1, 0.1, 7.1});
  cloud.add({-0.3, 0.3, 7.2});
  cloud.add({0.1, 0.1, 7.1});
  const auto points = cloud.points();
  ASSERT_EQ(points.size(), 2U);
  EXPECT_LT((points[0] - Eigen::Vector3f(-0.2F, 0.2F, 7.15F)).norm(), 1e-5F);
  EXPECT_LT((points[1] - Eigen::Vector3f(0.1F, 0.1F, 7.1F)).norm(), 1e-5F);
}

TEST(VoxelCloud, ThinsToOnePointPerVoxel) {
  VoxelCloud cloud(0.5, 1000);
  for (std::uint64_t i = 0; i < 20'000; ++i) cloud.add(point(i));
  EXPECT_EQ(cloud.size(), 400U);
  EXPECT_EQ(cloud.edge_m(), 0.5);
  for (const Eigen::Vector3f& p : cloud.points()) EXPECT_NEAR(p.y(), 0.03F, 1e-5F);
}

TEST(VoxelCloud, GetsCoarserRatherThanLarger) {
  VoxelCloud cloud(0.1, 1000);
  for (std::uint64_t i = 0; i < 20'000; ++i) cloud.add(point(i));
  EXPECT_LE(cloud.size(), 1000U);
  EXPECT_EQ(cloud.edge_m(), 0.4);
  for (const Eigen::Vector3f& p : cloud.points()) {
    EXPECT_LE(p.cwiseAbs().maxCoeff(), 5.0F);
    EXPECT_NEAR(p.y(), 0.03F, 1e-5F);
  }
}

TEST(VoxelCloud, LeavesOutWhatIsNotFiniteOrTooFar) {
  VoxelCloud cloud(0.1, 1000);
  cloud.add({std::nan(""), 0.0, 0.0});
  cloud.add({1e9, 0.0, 0.0});
  EXPECT_EQ(cloud.size(), 0U);
}

TEST(VoxelCloud, IsReadBackFromItsFile) {
  VoxelCloud cloud(0.5, 1000);
  for (std::uint64_t i = 0; i < 100; ++i) cloud.add(point(i));
  const auto file = test_folder() / "voxels.ply";
  write_ply(file, cloud.points());
  EXPECT_EQ(read_points(file), cloud.points());
}

}  // namespace
}  // namespace fleetloc
