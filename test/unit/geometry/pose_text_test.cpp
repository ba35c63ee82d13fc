#include "shared/geometry/pose_text.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

namespace fleetloc {
namespace {

TEST(PoseText, RoundTripKeepsThePose) {
  const Pose T{Eigen::Quaterniond(0.5, -0.1, 0.7, 0.2).normalized(), {1.0, -2.0, 0.5}};
  EXPECT_LT(local_coordinates(T, pose_from_text(pose_text(T))).norm(), 1e-8);
}

TEST(PoseText, NormalizesTheQuaternion) {
  EXPECT_NEAR(pose_from_text("1 2 3 0 0 0 2").R.norm(), 1.0, 1e-15);
}

TEST(PoseText, RefusesWhatIsNoPose) {
  for (const char* text :
       {"", "1 2 3", "1 2 3 0 0 0 x", "1 2 3 0 0 0 nan", "1 2 3 0 0 0 0", "1 2 3 0 0 0 1 9"}) {
    EXPECT_THROW(pose_from_text(text), std::invalid_argument) << text;
  }
}

}  // namespace
}  // namespace fleetloc
