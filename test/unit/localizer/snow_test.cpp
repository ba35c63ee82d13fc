// Ground that has been lifted since the survey, in a yard of 20 m x 20 m between walls: snow beside
// a way that was cleared.
#include <vector>

#include <gtest/gtest.h>

#include "cloud/localizer/map_association.hpp"
#include "cloud/localizer/rigid_alignment.hpp"
#include "shared/core/counter_random.hpp"
#include "simulated_session.hpp"

namespace fleetloc {
namespace {

constexpr double kSnow = 0.4;  // [m]

LaserMap yard() {
  std::vector<MapPoint> points;
  const auto add = [&points](double x, double y, double z, const Eigen::Vector3f& normal) {
    const Eigen::Vector3d p_map(x, y, z);
    points.push_back({.p_map = p_map.cast<float>(), .normal = normal, .planarity = 1.0F});
  };
  for (int i = 0; i <= 200; ++i) {
    for (int j = 0; j <= 200; ++j) {
      add(0.1 * i - 10.0, 0.1 * j - 10.0, 0.0, Eigen::Vector3f::UnitZ());
      if (j > 30) continue;
      for (const double side : {-10.0, 10.0}) {
        add(0.1 * i - 10.0, side, 0.1 * j, Eigen::Vector3f::UnitY());
        add(side, 0.1 * i - 10.0, 0.1 * j, Eigen::Vector3f::UnitX());
      }
    }
  }
  return LaserMap(std::move(points), {.frame = "map", .resolution_m = 0.1});
}

/// What a robot in the middle sees: walls, and ground of which a share is the cleared way.
std::vector<WindowLandmark> landmarks_of(double cleared_share) {
  std::vector<WindowLandmark> landmarks;
  const auto add = [&landmarks](const Eigen::Vector3d& p_map) {
    const LandmarkId id{static_cast<unsigned>(landmarks.size())};
    landmarks.push_back({.id = id,
                         .p_map = p_map,
                         .viewpoint_map = {0.0, 0.0, 1.0},
                         .covariance = 4e-4 * Eigen::Matrix3d::Identity()});
  };
  const CounterRandom random(11, 0);
  for (unsigned i = 0; i < 300; ++i) {
    const Eigen::Vector3d noise = 0.02 * random.normal3(i);
    const double along = 0.06 * i - 9.0;
    const double side = i % 2 == 0 ? 10.0 : -10.0;
    if (i < 100) {
      const double height = i % 10 < 10.0 * cleared_share ? 0.0 : kSnow;
      add(Eigen::Vector3d(3.0 * along + 18.0, 0.3 * side, height) + noise);
    } else if (i < 200) {
      add(Eigen::Vector3d(side, along, 1.0) + noise);
    } else {
      add(Eigen::Vector3d(along, side, 1.5) + noise);
    }
  }
  return landmarks;
}

std::vector<WindowLandmark> moved(std::vector<WindowLandmark> landmarks, const Eigen::Vector3d& t) {
  for (WindowLandmark& landmark : landmarks) {
    landmark.p_map += t;
    landmark.viewpoint_map += t;
  }
  return landmarks;
}

TEST(Snow, CountsWhatWouldBeUnderTheGroundButNotWhatIsAboveIt) {
  const LaserMap map = yard();
  const auto config = localizer_config();
  const double gate_m = config.rounds.final_gate_m;
  const auto landmarks = landmarks_of(0.3);
  const Association right = associate(landmarks, map, gate_m, config.association);
  EXPECT_NEAR(right.level, 30, 3);
  EXPECT_EQ(right.below_ground, 0);
  const Eigen::Vector3d down = -kSnow * Eigen::Vector3d::UnitZ();
  const Association wrong = associate(moved(landmarks, down), map, gate_m, config.association);
  EXPECT_NEAR(wrong.level, 70, 3);
  EXPECT_NEAR(wrong.below_ground, 30, 3);
}

TEST(Snow, DoesNotPullAStartUnderTheGround) {
  const LaserMap map = yard();
  const auto config = localizer_config();
  const RigidAlignment alignment(map, config.association, config.alignment);
  const PoseWithCovariance prior{.T_map_body = Pose{}, .covariance = start_covariance()};
  const RigidAlignment::Gates gates{1.0, config.rounds.final_gate_m};
  for (const double cleared_share : {0.3, 1.0}) {
    const auto landmarks = landmarks_of(cleared_share);
    for (const double height : {-0.2, 0.0, 0.2}) {
      const Eigen::Vector3d error(0.2, -0.1, height);
      const Pose T_new_old = alignment.align(moved(landmarks, error), prior, gates);
      const Eigen::Vector3d rest = T_new_old * error;
      EXPECT_NEAR(rest.z(), 0.0, 0.12) << cleared_share << " cleared, from " << height;
      EXPECT_LT(rest.head<2>().norm(), 0.05) << cleared_share << " cleared, from " << height;
    }
  }
}

}  // namespace
}  // namespace fleetloc
