// Ground that has been lifted since the survey: snow beside a way that was cleared.
#include <gtest/gtest.h>

#include "cloud/localizer/map_association.hpp"
#include "cloud/localizer/rigid_alignment.hpp"
#include "simulated_session.hpp"
#include "simulated_yard.hpp"

namespace fleetloc {
namespace {

TEST(Snow, CountsWhatWouldBeUnderTheGroundButNotWhatIsAboveIt) {
  const LaserMap map = yard();
  const auto config = localizer_config().registration;
  const double gate_m = config.rounds.final_gate_m;
  const auto landmarks = landmarks_of_yard(0.3);
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
  const auto config = localizer_config().registration;
  const RigidAlignment alignment(map, config.association, config.alignment);
  const PoseWithCovariance prior{.T_map_body = Pose{}, .covariance = start_covariance()};
  const RigidAlignment::Gates gates{1.0, config.rounds.final_gate_m};
  for (const double cleared_share : {0.3, 1.0}) {
    const auto landmarks = landmarks_of_yard(cleared_share);
    for (const double height : {-0.2, 0.0, 0.2}) {
      const Eigen::Vector3d error(0.2, -0.1, height);
      const Pose T_new_old = alignment.align(moved(landmarks, error), prior, gates).T_new_old;
      const Eigen::Vector3d rest = T_new_old * error;
      EXPECT_NEAR(rest.z(), 0.0, 0.12) << cleared_share << " cleared, from " << height;
      EXPECT_LT(rest.head<2>().norm(), 0.05) << cleared_share << " cleared, from " << height;
    }
  }
}

}  // namespace
}  // namespace fleetloc
