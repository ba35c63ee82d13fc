// Places beside the best one that fit nearly as well: a facade with equal pilasters.
#include <cmath>
#include <iostream>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "cloud/localizer/rigid_alignment.hpp"
#include "shared/core/counter_random.hpp"
#include "simulated_session.hpp"
#include "simulated_yard.hpp"

namespace fleetloc {
namespace {

constexpr double kPitch = 0.5;  // of the pilasters [m]

/// A point of the facade, or a landmark on it.
struct SurfacePoint {
  Eigen::Vector3d p_map;
  Eigen::Vector3d normal;
};

/// A wall at y = 3, pilasters on it, and a wall that ends the facade on its right, if it does.
std::vector<SurfacePoint> facade(double spacing_m, bool has_end) {
  std::vector<SurfacePoint> points;
  const auto grid = [&](const Eigen::Vector3d& corner,
                        const Eigen::Vector3d& along,
                        double length_m,
                        const Eigen::Vector3d& normal) {
    for (double s = 0.0; s < length_m; s += spacing_m) {
      for (double z = 0.0; z < 2.0; z += spacing_m) {
        points.push_back({corner + s * along + z * Eigen::Vector3d::UnitZ(), normal});
      }
    }
  };
  grid({-8.0, 3.0, 0.0}, Eigen::Vector3d::UnitX(), 16.0, -Eigen::Vector3d::UnitY());
  for (double x = -8.0; x < 8.0; x += kPitch) {
    grid({x, 2.8, 0.0}, Eigen::Vector3d::UnitY(), 0.2, Eigen::Vector3d::UnitX());
  }
  if (has_end) grid({2.8, 0.0, 0.0}, Eigen::Vector3d::UnitY(), 2.8, -Eigen::Vector3d::UnitX());
  return points;
}

LaserMap map_of_facade(bool has_end) {
  std::vector<MapPoint> points;
  for (const auto& [p_map, normal] : facade(0.05, has_end)) {
    points.push_back(
        {.p_map = p_map.cast<float>(), .normal = normal.cast<float>(), .planarity = 1.0F});
  }
  return LaserMap(std::move(points), {.frame = "map", .resolution_m = 0.05});
}

/// What a robot at the origin sees of it, with 2 cm noise.
std::vector<WindowLandmark> landmarks_of_facade(bool has_end) {
  const CounterRandom random(5, 0);
  std::vector<WindowLandmark> landmarks;
  for (const auto& [p_map, normal] : facade(0.19, has_end)) {
    if (std::abs(p_map.x()) > 4.0) continue;
    const auto index = static_cast<unsigned>(landmarks.size());
    landmarks.push_back({.id = LandmarkId{index},
                         .p_map = p_map + 0.02 * random.normal3(index),
                         .viewpoint_map = {0.0, 0.0, 1.0},
                         .covariance = 4e-4 * Eigen::Matrix3d::Identity()});
  }
  return landmarks;
}

/// One sigma along the facade by its rivals, of a robot that is known to half a metre.
double rivals_along_m(bool has_end) {
  const LaserMap map = map_of_facade(has_end);
  const auto config = localizer_config().registration;
  Vector6d sigmas;
  sigmas << 0.02, 0.02, 0.02, 0.5, 0.1, 0.1;
  const PoseWithCovariance prior{.T_map_body = Pose{},
                                 .covariance = sigmas.cwiseAbs2().asDiagonal()};
  const RigidAlignment alignment(map, config.association, config.alignment);
  const auto aligned =
      alignment.align(landmarks_of_facade(has_end), prior, {0.5, config.rounds.final_gate_m});
  std::cout << "rivals: sigmas " << aligned.rivals.diagonal().cwiseSqrt().transpose() << '\n';
  EXPECT_LT(std::sqrt(aligned.rivals(4, 4)), 0.05) << "across, where there are none";
  return std::sqrt(aligned.rivals(3, 3));
}

TEST(RivalPlaces, AreStatedWhereTheFacadeRepeatsItself) {
  EXPECT_GT(rivals_along_m(false), 0.5 * kPitch);
}

TEST(RivalPlaces, AreNoneWhereItHasAnEnd) {
  EXPECT_LT(rivals_along_m(true), 0.05);
}

}  // namespace
}  // namespace fleetloc
