// A session of which nobody tells where it begins.
#include "cloud/localizer/first_place.hpp"

#include <algorithm>
#include <cstdio>
#include <functional>
#include <optional>

#include <gtest/gtest.h>

#include "cloud/localizer/session_localizer.hpp"
#include "simulated_session.hpp"
#include "simulated_yard.hpp"

namespace fleetloc {
namespace {

RobotSession without_start(const SimulatedSession& robot) {
  RobotSession session = robot.session();
  session.start.reset();
  return session;
}

/// An answer to keyframe `i`, after all turns of a search that it begins.
LocalizationResult answer_to(SessionLocalizer& localizer, const SimulatedSession& robot, int i) {
  localizer.add(robot.submap(i));
  LocalizationResult answer = localizer.localize();
  while (localizer.is_searching()) answer = localizer.localize();
  return answer;
}

/// Whether one of the places where a robot may be is its own: they are aligned after each metre.
bool has_truth(const std::vector<PlaceHypotheses::Place>& places, const Pose& truth) {
  return std::ranges::any_of(places, [&truth](const PlaceHypotheses::Place& place) {
    return (place.T_map_body.p - truth.p).norm() < 1.5;
  });
}

/// The first keyframe that is localized, if one of the first `count` is.
std::optional<int> first_localized(SessionLocalizer& localizer,
                                   const SimulatedSession& robot,
                                   int count) {
  for (int i = 0; i < count; ++i) {
    const LocalizationResult answer = answer_to(localizer, robot, i);
    if (answer.status != LocalizationStatus::kLocalized) continue;
    EXPECT_LT(position_error(answer, robot.truth(i)), 0.25) << "keyframe " << i;
    EXPECT_LT(rotation_error(answer, robot.truth(i)), 0.03) << "keyframe " << i;
    return i;
  }
  return std::nullopt;
}

// Turned by half, the room is nearly the same.
TEST(FirstPlace, IsFoundInARoomOrSaidToBeOneOfTwo) {
  constexpr int kSeeds = 10;
  constexpr int kKeyframes = 40;
  const auto pyramid = make_pyramid(*room_map(), kSmallPyramid);
  int found = 0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const SimulatedSession robot({.seed = seed});
    SessionLocalizer localizer(without_start(robot), room_map(), localizer_config(), pyramid);
    const auto first = first_localized(localizer, robot, kKeyframes);
    if (!first) {
      const auto places = localizer.possible_places();
      ASSERT_EQ(places.size(), 2U) << "seed " << seed;
      EXPECT_EQ(localizer.first_place()->places_left(), 2U) << "seed " << seed;
      EXPECT_TRUE(has_truth(places, robot.truth(kKeyframes - 1))) << "seed " << seed;
      EXPECT_LT(places[0].log_odds, 1e-12);
      EXPECT_LT(places[1].log_odds, localizer_config().first_place.hypotheses.min_log_odds);
      EXPECT_EQ(name(answer_to(localizer, robot, kKeyframes).status), "ambiguous");
      continue;
    }
    ++found;
    EXPECT_TRUE(localizer.possible_places().empty());
    EXPECT_EQ(localizer.first_place()->places_left(), 1U) << "seed " << seed;
    // As any other start: answers go on.
    EXPECT_EQ(name(answer_to(localizer, robot, *first + 1).status),
              name(LocalizationStatus::kLocalized));
  }
  std::printf("found %d of %d\n", found, kSeeds);
  EXPECT_GE(found, 9) << "by the rays that must be free";
}

/// The room twice, far apart; of the second one what `has_too` says of points of the first.
std::shared_ptr<const LaserMap> two_rooms(
    const std::function<bool(const Eigen::Vector3d&)>& has_too) {
  const std::vector<Eigen::Vector3d> room = SimulatedRun({}).surface_points(0.06);
  std::vector<Eigen::Vector3d> both = room;
  for (const Eigen::Vector3d& p : room) {
    if (has_too(p)) both.emplace_back(p + Eigen::Vector3d(40.0, 0.0, 0.0));
  }
  return std::make_shared<const LaserMap>(map_of(both, 0.01, 1));
}

TEST(FirstPlace, IsAmbiguousInOneOfTwoRoomsAndFollowedInBoth) {
  const auto rooms = two_rooms([](const auto&) { return true; });
  const auto pyramid = make_pyramid(*rooms, kSmallPyramid);
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const SimulatedSession robot({.seed = seed});
    SessionLocalizer localizer(without_start(robot), rooms, localizer_config(), pyramid);
    int ambiguous = 0;
    for (int i = 0; i < 40; ++i) {
      const LocalizationResult answer = answer_to(localizer, robot, i);
      ASSERT_NE(name(answer.status), name(LocalizationStatus::kLocalized)) << seed << ", " << i;
      if (answer.status != LocalizationStatus::kAmbiguous) continue;
      ++ambiguous;
      const auto places = localizer.possible_places();
      EXPECT_GE(places.size(), 2U);
      Pose other = robot.truth(i);
      other.p.x() += 40.0;
      EXPECT_TRUE(has_truth(places, robot.truth(i))) << seed << ", " << i;
      EXPECT_TRUE(has_truth(places, other)) << seed << ", " << i;
    }
    EXPECT_GE(ambiguous, 15) << "seed " << seed;
  }
}

TEST(FirstPlace, IsFoundAmongTwoRoomsOnceTheyDiffer) {
  const auto rooms = two_rooms([](const Eigen::Vector3d& p) { return p.x() < 1.0; });
  const auto pyramid = make_pyramid(*rooms, kSmallPyramid);
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const SimulatedSession robot({.seed = seed});
    SessionLocalizer localizer(without_start(robot), rooms, localizer_config(), pyramid);
    if (first_localized(localizer, robot, 40)) ++found;
  }
  std::printf("found %d of 5\n", found);
  EXPECT_GE(found, 4);
}

TEST(FirstPlace, IsNotAcceptedInTheMapOfAnotherPlace) {
  const auto another = std::make_shared<const LaserMap>(yard());
  const auto pyramid = make_pyramid(*another, kSmallPyramid);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const SimulatedSession robot({.seed = seed});
    SessionLocalizer localizer(without_start(robot), another, localizer_config(), pyramid);
    LocalizationResult answer;
    for (int i = 0; i < 40; ++i) {
      answer = answer_to(localizer, robot, i);
      ASSERT_NE(name(answer.status), name(LocalizationStatus::kLocalized)) << seed << ", " << i;
    }
    EXPECT_EQ(name(answer.status), "no_map_coverage") << "seed " << seed;
  }
}

/// With a start pose that is known to these sigmas only.
RobotSession with_start(const SimulatedSession& robot, double sigma_m, double sigma_rad) {
  RobotSession session = robot.session();
  session.start->covariance = diagonal_covariance(sigma_rad, sigma_m);
  return session;
}

TEST(FirstPlace, OfAStartPoseIsSearchedAroundItIfThatIsUncertain) {
  const SimulatedSession robot({.seed = 1});
  const FirstPlace::Config config = localizer_config().first_place;
  const auto region = [&](double sigma_m, double sigma_rad) {
    return FirstPlace::region_of(*with_start(robot, sigma_m, sigma_rad).start, config);
  };
  EXPECT_FALSE(region(0.5, 0.1));
  ASSERT_TRUE(region(10.0, 0.1));
  EXPECT_NEAR(region(10.0, 0.1)->radius_m, 30.0, 1e-9);
  ASSERT_TRUE(region(0.5, 3.0)) << "a heading that nobody knows";
  const MapOdomEstimate& start = *robot.session().start;
  EXPECT_LT((region(10.0, 0.1)->p_map - start.T_map_odom * start.p_odom).norm(), 1e-12);
}

TEST(FirstPlace, IsFoundWhereOnlyTheHeadingIsUnknown) {
  const auto pyramid = make_pyramid(*room_map(), kSmallPyramid);
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const SimulatedSession robot({.seed = seed, .start_yaw_rad = 2.0});
    const RobotSession session = with_start(robot, 0.3, 3.0);
    SessionLocalizer localizer(session, room_map(), localizer_config(), pyramid);
    if (first_localized(localizer, robot, 40)) ++found;
  }
  std::printf("found %d of 5\n", found);
  EXPECT_GE(found, 3);
}

TEST(FirstPlace, IsLookedForOnlyOnTheWay) {
  const auto pyramid = make_pyramid(*room_map(), kSmallPyramid);
  const SimulatedSession robot({.seed = 1});
  SessionLocalizer localizer(without_start(robot), room_map(), localizer_config(), pyramid);
  const LocalizationResult answer = answer_to(localizer, robot, 0);
  EXPECT_EQ(name(answer.status), name(LocalizationStatus::kSearching));
  EXPECT_FALSE(localizer.is_searching());
}

}  // namespace
}  // namespace fleetloc
