// A session of which somebody tells in which part of the map it begins.
#include <cstdio>
#include <optional>

#include <gtest/gtest.h>

#include "cloud/localizer/first_place.hpp"
#include "cloud/localizer/session_localizer.hpp"
#include "searched_session.hpp"
#include "simulated_session.hpp"

namespace fleetloc {
namespace {

constexpr int kSeedsInRegion = 3;
constexpr int kKeyframesSearched = 40;

TEST(FirstPlaceInRegion, OfAStartPoseIsSearchedAroundItIfThatIsUncertain) {
  const SimulatedSession robot({.seed = 1});
  const FirstPlace::Config config = localizer_config().first_place;
  const auto region = [&](double sigma_m, double sigma_rad) {
    return FirstPlace::region_of(*with_start(robot, sigma_m, sigma_rad).start, config);
  };
  EXPECT_FALSE(region(0.5, 0.1));
  ASSERT_TRUE(region(10.0, 0.1));
  EXPECT_NEAR(region(10.0, 0.1)->where.radius_m, 30.0, 1e-9);
  ASSERT_TRUE(region(0.5, 3.0)) << "a heading that nobody knows";
  const MapOdomEstimate& start = *robot.session().start;
  const MapRegion around = region(10.0, 0.1)->where;
  const Eigen::Vector3d p_map = start.T_map_odom * start.p_odom;
  EXPECT_LT((0.5 * (around.min_map + around.max_map) - p_map.head<2>()).norm(), 1e-12);
}

RobotSession began_in_region(const SimulatedSession& robot) {
  RobotSession session = without_start(robot);
  session.region = StartRegion{.p_odom = robot.T_odom_body(0).p};
  return session;
}

/// In a map that has the room twice.
/// @param second  where the other one is
/// @param told    the region that the robot is said to be in
/// @param is_it_second  what is in that region
/// @return in how many of the runs it was found, each time there
int found_in(const Eigen::Vector3d& second, const MapRegion& told, bool is_it_second) {
  const auto rooms = two_rooms(second);
  const auto pyramid = make_pyramid(*rooms, kSmallPyramid);
  int found = 0;
  for (std::uint64_t seed = 1; seed <= kSeedsInRegion; ++seed) {
    const SimulatedSession robot({.seed = seed});
    SessionLocalizer localizer(began_in_region(robot), rooms, localizer_config(), pyramid, told);
    for (int i = 0; i < kKeyframesSearched; ++i) {
      const LocalizationResult answer = answer_to(localizer, robot, i);
      if (answer.status != LocalizationStatus::kLocalized) continue;
      ++found;
      Pose truth = robot.truth(i);
      if (is_it_second) truth.p += second;
      EXPECT_LT(position_error(answer, truth), 0.25) << "seed " << seed;
      break;
    }
  }
  std::printf("found %d of %d\n", found, kSeedsInRegion);
  return found;
}

// Without the region none is: FirstPlace.IsAmbiguousInOneOfTwoRoomsAndFollowedInBoth.
TEST(FirstPlaceInRegion, IsFoundInTheOneOfTwoRoomsThatIsTold) {
  const Eigen::Vector3d beside(40.0, 0.0, 0.0);
  const auto circle_about = [](double x) { return MapRegion::circle({x, 0.0}, 15.0); };
  EXPECT_GE(found_in(beside, circle_about(0.0), false), 2);
  EXPECT_GE(found_in(beside, circle_about(40.0), true), 2);
}

TEST(FirstPlaceInRegion, IsFoundInTheStoreyThatIsTold) {
  const Eigen::Vector3d above(0.0, 0.0, 8.0);
  EXPECT_GE(found_in(above, {.lowest_m = -1.0, .highest_m = 3.5}, false), 2);
  EXPECT_GE(found_in(above, {.lowest_m = 7.0, .highest_m = 11.5}, true), 2);
}

TEST(FirstPlaceInRegion, IsFoundInTheStoreyThatIsToldThoughItHasClimbedSince) {
  const Eigen::Vector3d climbed(0.0, 0.0, 5.0);
  const auto pyramid = make_pyramid(*room_map(), kSmallPyramid);
  const SimulatedSession robot({.seed = 1});
  RobotSession session = began_in_region(robot);
  session.region->p_odom -= climbed;
  const MapRegion cellar{.lowest_m = -6.0, .highest_m = -1.5};
  SessionLocalizer localizer(session, room_map(), localizer_config(), pyramid, cellar);
  EXPECT_TRUE(first_localized(localizer, robot, kKeyframesSearched));
}

TEST(FirstPlaceInRegion, IsAmbiguousInOneOfTwoStoreysOfWhichNoneIsTold) {
  const Eigen::Vector3d above(0.0, 0.0, 8.0);
  const auto rooms = two_rooms(above);
  const auto pyramid = make_pyramid(*rooms, kSmallPyramid);
  for (std::uint64_t seed = 1; seed <= kSeedsInRegion; ++seed) {
    const SimulatedSession robot({.seed = seed});
    SessionLocalizer localizer(without_start(robot), rooms, localizer_config(), pyramid);
    int ambiguous = 0;
    for (int i = 0; i < kKeyframesSearched; ++i) {
      const LocalizationResult answer = answer_to(localizer, robot, i);
      ASSERT_NE(name(answer.status), name(LocalizationStatus::kLocalized)) << seed << ", " << i;
      if (answer.status != LocalizationStatus::kAmbiguous) continue;
      ++ambiguous;
      Pose other = robot.truth(i);
      other.p += above;
      EXPECT_TRUE(has_truth(localizer.possible_places(), robot.truth(i))) << seed << ", " << i;
      EXPECT_TRUE(has_truth(localizer.possible_places(), other)) << seed << ", " << i;
    }
    EXPECT_GE(ambiguous, 15) << "seed " << seed;
  }
}

TEST(FirstPlaceInRegion, IsNeverFoundBesideIt) {
  const SimulatedSession robot({.seed = 1});
  const auto pyramid = make_pyramid(*room_map(), kSmallPyramid);
  const Eigen::Vector2d start = robot.truth(0).p.head<2>();
  const Eigen::Vector2d beside = start + Eigen::Vector2d(4.0, 0.0);
  for (const MapRegion& told : {MapRegion::nowhere(),
                                MapRegion::circle(start + Eigen::Vector2d(60.0, 0.0), 10.0),
                                MapRegion::circle(beside, 2.0)}) {
    SessionLocalizer localizer(
        began_in_region(robot), room_map(), localizer_config(), pyramid, told);
    for (int i = 0; i < kKeyframesSearched; ++i) {
      const LocalizationResult answer = answer_to(localizer, robot, i);
      ASSERT_NE(name(answer.status), name(LocalizationStatus::kLocalized))
          << i << " at " << answer.T_map_body.p.transpose();
      const bool is_near = told.radius_m == 2.0;
      if (i > 20 && !is_near) {
        EXPECT_EQ(name(answer.status), "no_map_coverage") << i;
        EXPECT_EQ(answer.places, 0);
      }
    }
  }
}

}  // namespace
}  // namespace fleetloc
