// A session of which nobody tells where it begins.
#include "cloud/localizer/first_place.hpp"

#include <cstdio>
#include <optional>

#include <gtest/gtest.h>

#include "cloud/localizer/session_localizer.hpp"
#include "cloud/locate/pyramid_config.hpp"
#include "simulated_session.hpp"
#include "simulated_yard.hpp"

namespace fleetloc {
namespace {

constexpr PyramidConfig kPyramid{
    .min_cell_m = 0.25, .max_cell_m = 0.5, .cells = 400, .levels = 6, .level_from = 0.9};

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
  const auto pyramid = make_pyramid(*room_map(), kPyramid);
  int found = 0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const SimulatedSession robot({.seed = seed});
    SessionLocalizer localizer(without_start(robot), room_map(), localizer_config(), pyramid);
    const auto first = first_localized(localizer, robot, kKeyframes);
    if (!first) {
      EXPECT_EQ(localizer.places_left(), 2U) << "seed " << seed;
      continue;
    }
    ++found;
    EXPECT_EQ(localizer.places_left(), 1U) << "seed " << seed;
    // As any other start: answers go on.
    EXPECT_EQ(name(answer_to(localizer, robot, *first + 1).status),
              name(LocalizationStatus::kLocalized));
  }
  std::printf("found %d of %d\n", found, kSeeds);
  EXPECT_GE(found, 4);
}

TEST(FirstPlace, IsNotAcceptedInTheMapOfAnotherPlace) {
  const auto another = std::make_shared<const LaserMap>(yard());
  const auto pyramid = make_pyramid(*another, kPyramid);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const SimulatedSession robot({.seed = seed});
    SessionLocalizer localizer(without_start(robot), another, localizer_config(), pyramid);
    for (int i = 0; i < 40; ++i) {
      const LocalizationResult answer = answer_to(localizer, robot, i);
      ASSERT_NE(name(answer.status), name(LocalizationStatus::kLocalized)) << seed << ", " << i;
    }
  }
}

TEST(FirstPlace, IsLookedForOnlyOnTheWay) {
  const auto pyramid = make_pyramid(*room_map(), kPyramid);
  const SimulatedSession robot({.seed = 1});
  SessionLocalizer localizer(without_start(robot), room_map(), localizer_config(), pyramid);
  const LocalizationResult answer = answer_to(localizer, robot, 0);
  EXPECT_EQ(name(answer.status), name(LocalizationStatus::kSearching));
  EXPECT_FALSE(localizer.is_searching());
}

}  // namespace
}  // namespace fleetloc
