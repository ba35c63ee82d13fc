#include "deploy/sim/sensors/lidar.hpp"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>

#include "shared/dataset/sensor_file.hpp"
#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

constexpr double kDeg = std::numbers::pi / 180.0;
constexpr Timestamp kScanStart{std::chrono::seconds(1000)};
constexpr float kHalf = 10.0F;

/// A room about the origin, 20 m wide in each direction.
RayCaster box() {
  Mesh mesh;
  for (const float x : {-kHalf, kHalf}) {
    for (const float y : {-kHalf, kHalf}) {
      for (const float z : {-kHalf, kHalf}) mesh.vertices.emplace_back(x, y, z);
    }
  }
  mesh.triangles = {{0, 1, 3},
                    {0, 3, 2},
                    {4, 6, 7},
                    {4, 7, 5},
                    {0, 4, 5},
                    {0, 5, 1},
                    {2, 3, 7},
                    {2, 7, 6},
                    {0, 2, 6},
                    {0, 6, 4},
                    {1, 5, 7},
                    {1, 7, 3}};
  mesh.surfaces.assign(mesh.triangles.size(), 0U);
  return RayCaster(mesh);
}

LidarConfig config_of(double sigma_m, double dropout_share) {
  LidarConfig config;
  config.calibration.T_body_lidar = {.R = exp_so3({0.02, -0.03, 0.5}), .p = {0.1, -0.2, 0.4}};
  config.lowest_rad = -15.0 * kDeg;
  config.highest_rad = 15.0 * kDeg;
  config.range_sigma_m = sigma_m;
  config.dropout_share = dropout_share;
  config.min_m = 0.5;
  config.max_m = 100.0;
  config.max_incidence_rad = 89.0 * kDeg;
  return config;
}

/// Fast for a ground robot: moves and turns by a decimetre and several degrees in one scan.
SplineMotion moving() {
  return spline_through(grid_over(4.0, 0.05), [](double t) {
    return Pose{.R = exp_so3({0.0, 0.0, 0.9 * t}), .p = {1.5 * t - 3.0, 0.4 * t, 0.1}};
  });
}

SplineMotion standing() {
  return spline_through(grid_over(4.0, 0.5), [](double) { return Pose{}; });
}

/// Distance of a point in map from the walls of the box.
double off_the_walls(const Eigen::Vector3d& p_map) {
  return std::abs(p_map.cwiseAbs().maxCoeff() - static_cast<double>(kHalf));
}

Pose lidar_pose(const Lidar& lidar, const SplineMotion& motion, std::uint64_t scan, int column) {
  const LidarCalibration& calibration = lidar.config().calibration;
  const double time_s = lidar.scan_time_s(scan) + calibration.column_time_s(column);
  return motion.at(time_s).T_map_body * calibration.T_body_lidar;
}

TEST(Lidar, WithoutNoisePutsEveryPointOnTheWallsFromThePoseOfItsOwnTime) {
  const Lidar lidar(config_of(0.0, 0.0), 1);
  const SplineMotion motion = moving();
  const LidarScan scan = lidar.scan(box(), motion, kScanStart, 12);
  EXPECT_EQ(scan.stamp, kScanStart + std::chrono::milliseconds(1200));
  ASSERT_EQ(scan.points.size(), 16U * 1800U);
  double with_motion = 0.0;
  double frozen = 0.0;
  for (const LidarPoint& point : scan.points) {
    const Eigen::Vector3d p = point.p_lidar.cast<double>();
    with_motion =
        std::max(with_motion, off_the_walls(lidar_pose(lidar, motion, 12, point.column) * p));
    frozen = std::max(frozen, off_the_walls(lidar_pose(lidar, motion, 12, 0) * p));
  }
  EXPECT_LT(with_motion, 1e-4);
  EXPECT_GT(frozen, 0.3);  // what a user who forgets the motion gets
}

TEST(Lidar, HasItsRingsAndColumnsWhereTheyBelong) {
  const Lidar lidar(config_of(0.0, 0.0), 1);
  const LidarScan scan = lidar.scan(box(), standing(), kScanStart, 0);
  for (std::size_t i = 0; i < scan.points.size(); i += 37) {
    const LidarPoint& point = scan.points[i];
    const Eigen::Vector3f& p = point.p_lidar;
    const double elevation = std::atan2(p.z(), p.head<2>().norm());
    EXPECT_NEAR(elevation, (-15.0 + 2.0 * point.ring) * kDeg, 1e-5);
    const double azimuth = std::atan2(p.y(), p.x());
    EXPECT_NEAR(
        std::remainder(azimuth - point.column * 0.2 * kDeg, 2.0 * std::numbers::pi), 0.0, 1e-5);
  }
}

TEST(Lidar, RangeNoiseAndDropoutsAreAsConfigured) {
  const Lidar lidar(config_of(0.03, 0.1), 7);
  const Lidar exact(config_of(0.0, 0.0), 7);
  const SplineMotion motion = standing();
  const auto noisy = lidar.scan(box(), motion, kScanStart, 3);
  const auto truth = exact.scan(box(), motion, kScanStart, 3);
  EXPECT_NEAR(static_cast<double>(noisy.points.size()) / static_cast<double>(truth.points.size()),
              0.9,
              0.01);
  double squares = 0.0;
  double sum = 0.0;
  for (const LidarPoint& point : noisy.points) {
    const LidarPoint& same = truth.points[16U * point.column + point.ring];
    const double error = point.p_lidar.norm() - same.p_lidar.norm();
    squares += error * error;
    sum += error;
    EXPECT_LT(point.p_lidar.normalized().cross(same.p_lidar.normalized()).norm(), 1e-6);
  }
  const auto count = static_cast<double>(noisy.points.size());
  EXPECT_NEAR(std::sqrt(squares / count), 0.03, 0.001);
  EXPECT_NEAR(sum / count, 0.0, 0.001);
}

TEST(Lidar, SeesNothingTooNearTooFarOrTooGrazing) {
  LidarConfig config = config_of(0.0, 0.0);
  config.max_m = 12.0;
  config.min_m = 10.5;
  for (const LidarPoint& point : Lidar(config, 1).scan(box(), standing(), kScanStart, 0).points) {
    EXPECT_LE(point.p_lidar.norm(), 12.0F);
    EXPECT_GE(point.p_lidar.norm(), 10.5F);
  }
  config = config_of(0.0, 0.0);
  config.max_incidence_rad = 20.0 * kDeg;
  config.calibration.T_body_lidar = {};
  for (const LidarPoint& point : Lidar(config, 1).scan(box(), standing(), kScanStart, 0).points) {
    EXPECT_GE(point.p_lidar.normalized().cwiseAbs().maxCoeff(), std::cos(20.1 * kDeg));
  }
}

TEST(Lidar, IsTheSameForOneSeedInAnyOrderOfScans) {
  const Lidar lidar(config_of(0.03, 0.1), 7);
  const Lidar again(config_of(0.03, 0.1), 7);
  const Lidar other(config_of(0.03, 0.1), 8);
  const RayCaster world = box();
  const SplineMotion motion = moving();
  const auto first = lidar.scan(world, motion, kScanStart, 2);
  static_cast<void>(again.scan(world, motion, kScanStart, 5));
  const auto second = again.scan(world, motion, kScanStart, 2);
  ASSERT_EQ(first.points.size(), second.points.size());
  for (std::size_t i = 0; i < first.points.size(); ++i) {
    ASSERT_EQ(first.points[i].p_lidar, second.points[i].p_lidar);
  }
  EXPECT_NE(other.scan(world, motion, kScanStart, 2).points.size(), first.points.size());
}

}  // namespace
}  // namespace fleetloc
