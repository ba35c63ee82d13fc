// A session of which nobody tells where it begins.
#include "cloud/localizer/first_place.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include <gtest/gtest.h>

#include "cloud/localizer/session_localizer.hpp"
#include "searched_session.hpp"
#include "simulated_session.hpp"
#include "simulated_yard.hpp"

namespace fleetloc {
namespace {

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

const Eigen::Vector3d kBeside(40.0, 0.0, 0.0);

TEST(FirstPlace, IsAmbiguousInOneOfTwoRoomsAndFollowedInBoth) {
  const auto rooms = two_rooms(kBeside);
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
      EXPECT_EQ(answer.places, static_cast<int>(places.size()));
      Pose other = robot.truth(i);
      other.p += kBeside;
      EXPECT_TRUE(has_truth(places, robot.truth(i))) << seed << ", " << i;
      EXPECT_TRUE(has_truth(places, other)) << seed << ", " << i;
    }
    EXPECT_GE(ambiguous, 15) << "seed " << seed;
  }
}

TEST(FirstPlace, IsFoundAmongTwoRoomsOnceTheyDiffer) {
  const auto rooms = two_rooms(kBeside, [](const Eigen::Vector3d& p) { return p.x() < 1.0; });
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

/// As if the map were larger than a room: a place that is the only one after some metres may be so
/// by chance.
SessionLocalizer::Config with_searched_path(double searched_path_m) {
  SessionLocalizer::Config config = localizer_config();
  config.confirmation.known_start_m = 0.1;
  config.confirmation.path_m = 3.0;
  config.confirmation.searched_path_m = searched_path_m;
  return config;
}

TEST(FirstPlace, IsLocalizedOnlyOnceALongWindowHasFoundIt) {
  const auto pyramid = make_pyramid(*room_map(), kSmallPyramid);
  const SimulatedSession robot({.seed = 1});
  const auto first_with = [&](double searched_path_m) {
    SessionLocalizer localizer(
        without_start(robot), room_map(), with_searched_path(searched_path_m), pyramid);
    return first_localized(localizer, robot, 40);
  };
  const auto from_short = first_with(1.5);
  const auto from_long = first_with(7.0);
  ASSERT_TRUE(from_short && from_long);
  EXPECT_GT(*from_long, *from_short);
  EXPECT_FALSE(first_with(1000.0));
}

// Not with the next submap only: a robot that has stopped sends none.
TEST(FirstPlace, IsLocalizedByTheSearchThatFindsItAgain) {
  const auto pyramid = make_pyramid(*room_map(), kSmallPyramid);
  const SimulatedSession robot({.seed = 1});
  SessionLocalizer localizer(without_start(robot), room_map(), with_searched_path(7.0), pyramid);
  for (int i = 0; i < 40; ++i) {
    const std::size_t searches = localizer.first_place()->searches();
    if (answer_to(localizer, robot, i).status != LocalizationStatus::kLocalized) continue;
    EXPECT_EQ(localizer.first_place()->searches(), searches + 1) << "keyframe " << i;
    return;
  }
  ADD_FAILURE() << "never localized";
}

// A search that is given up has seen that more places fit than can be told apart.
TEST(FirstPlace, IsNotLocalizedWhereTheLastSearchHasLeftMoreThanOne) {
  const auto pyramid = make_pyramid(*room_map(), kSmallPyramid);
  const SimulatedSession robot({.seed = 1});
  int doubted = 0;
  int found = 0;
  for (int max_evaluations = 260'000; max_evaluations <= 360'000; max_evaluations += 20'000) {
    SessionLocalizer::Config config = with_searched_path(1.5);
    config.confirmation.path_m = 6.0;
    config.first_place.max_evaluations = max_evaluations;
    config.first_place.turn_evaluations = 10'000;
    SessionLocalizer localizer(without_start(robot), room_map(), config, pyramid);
    bool was_found = false;
    for (int i = 0; i < 40; ++i) {
      const LocalizationResult answer = answer_to(localizer, robot, i);
      const bool is_only_one = localizer.first_place()->is_only_one_left();
      doubted += was_found && !is_only_one ? 1 : 0;
      was_found = was_found || is_only_one;
      if (answer.status != LocalizationStatus::kLocalized) continue;
      EXPECT_TRUE(is_only_one) << max_evaluations << " looks, keyframe " << i;
      ++found;
      break;
    }
  }
  EXPECT_GT(doubted, 0);
  EXPECT_GT(found, 0);
}

// A place in the map of a room is one of half a million.
TEST(FirstPlace, IsLookedForOnlyWithLandmarksEnoughToTellItFromAllOthers) {
  const auto pyramid = make_pyramid(*room_map(), kSmallPyramid);
  const SimulatedSession robot({.seed = 1});
  const auto searches_with = [&](double landmarks_per_log_place) {
    SessionLocalizer::Config config = localizer_config();
    config.first_place.landmarks_per_log_place = landmarks_per_log_place;
    SessionLocalizer localizer(without_start(robot), room_map(), config, pyramid);
    for (int i = 0; i < 20; ++i) answer_to(localizer, robot, i);
    return localizer.first_place()->searches();
  };
  EXPECT_GT(searches_with(1.0), 0U);
  const double all = localizer_config().first_place.max_landmarks;
  EXPECT_EQ(searches_with(all / std::log(1e5)), 0U) << "more than are looked for";
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
