#include "deploy/evaluation/errors/dead_reckoning.hpp"

#include <gtest/gtest.h>

#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

Timestamp at_second(int second) {
  return Timestamp(std::chrono::seconds(second));
}

Pose on_the_way(int second) {
  return {.R = exp_so3({0.0, 0.1, 0.2 * second}), .p = {1.0 * second, 0.5 * second, 0.1}};
}

const Pose kMapOdom{.R = exp_so3({0.01, -0.02, 1.3}), .p = {5.0, -3.0, 0.5}};

TEST(AlignedOnce, IsTheOdometryMovedByItsFirstPoseInTheMap) {
  Trajectory odometry;
  Trajectory localized;
  for (int i = 0; i < 10; ++i) odometry.push_back({at_second(i), on_the_way(i)});
  for (int i = 3; i < 10; ++i) {
    // Later poses in the map are elsewhere: they must not count.
    Pose T_map_body = kMapOdom * on_the_way(i);
    T_map_body.p.z() += 0.2 * (i - 3);
    localized.push_back({at_second(i), T_map_body});
  }
  const Trajectory control = aligned_once(odometry, localized);
  ASSERT_EQ(control.size(), localized.size());
  for (std::size_t i = 0; i < control.size(); ++i) {
    EXPECT_EQ(control[i].stamp, localized[i].stamp);
    const Pose expected = kMapOdom * on_the_way(static_cast<int>(i) + 3);
    EXPECT_LT(local_coordinates(expected, control[i].T_ref_body).norm(), 1e-12);
  }
}

TEST(AlignedOnce, LeavesOutStampsThatOnlyOneOfThemHas) {
  const Trajectory odometry{
      {at_second(1), on_the_way(1)}, {at_second(3), on_the_way(3)}, {at_second(4), on_the_way(4)}};
  const Trajectory localized{
      {at_second(0), {}}, {at_second(2), {}}, {at_second(3), on_the_way(7)}, {at_second(5), {}}};
  const Trajectory control = aligned_once(odometry, localized);
  ASSERT_EQ(control.size(), 1U);
  EXPECT_EQ(control.front().stamp, at_second(3));
  EXPECT_LT(local_coordinates(on_the_way(7), control.front().T_ref_body).norm(), 1e-12);
}

TEST(AlignedOnce, IsEmptyForARunThatWasNeverLocalized) {
  EXPECT_TRUE(aligned_once({{at_second(1), on_the_way(1)}}, {}).empty());
}

}  // namespace
}  // namespace fleetloc
