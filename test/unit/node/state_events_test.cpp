#include "robot/node/state_events.hpp"

#include <gmock/gmock.h>

namespace fleetloc {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

Timestamp at(double seconds) {
  return Timestamp(std::chrono::hours(400'000)) + from_seconds(seconds);
}

RobotOutput frame(double seconds, Quality quality) {
  RobotOutput output;
  output.frames.emplace_back().pose.stamp = at(seconds);
  output.frames.back().pose.quality = quality;
  return output;
}

RobotOutput answer(double seconds, LocalizationStatus status) {
  RobotOutput output;
  LocalizationOutput& answer = output.answers.emplace_back();
  answer.arrival = at(seconds);
  answer.answer.status = status;
  answer.answer.localizer = "localizer_1";
  return output;
}

TEST(StateEvents, TellAStateOnceItHasLasted) {
  StateEvents events;
  EXPECT_THAT(events.add(frame(0.0, Quality::kInitializing)), IsEmpty());
  EXPECT_THAT(events.add(frame(1.0, Quality::kLocalized)), IsEmpty());
  EXPECT_THAT(events.add(frame(2.0, Quality::kLocalized)), ElementsAre("state: localized"));
  EXPECT_THAT(events.add(frame(9.0, Quality::kLocalized)), IsEmpty()) << "told already";
}

TEST(StateEvents, DoNotTellOfAnInstant) {
  StateEvents events;
  for (const double second : {1.0, 2.0}) events.add(frame(second, Quality::kLocalized));
  for (const double second : {3.0, 5.0, 7.0}) {
    EXPECT_THAT(events.add(frame(second, Quality::kDeadReckoning)), IsEmpty());
    EXPECT_THAT(events.add(frame(second + 0.9, Quality::kLocalized)), IsEmpty());
  }
}

TEST(StateEvents, GoOnAfterAStepOfTheClock) {
  StateEvents events;
  for (const double second : {101.0, 102.0}) events.add(frame(second, Quality::kLocalized));
  EXPECT_THAT(events.add(frame(3.0, Quality::kLost)), IsEmpty());
  EXPECT_THAT(events.add(frame(4.0, Quality::kLost)), ElementsAre("state: lost"));
}

TEST(StateEvents, TellWhyWhileTheRobotIsNotLocalized) {
  StateEvents events;
  const auto missed = LocalizationStatus::kNoMapCoverage;
  EXPECT_THAT(events.add(answer(1.0, missed)),
              ElementsAre("not localized: no_map_coverage, says localizer_1"));
  EXPECT_THAT(events.add(answer(2.0, missed)), IsEmpty());
  EXPECT_THAT(events.add(answer(3.0, LocalizationStatus::kPoorFit)), IsEmpty()) << "soon";
  EXPECT_THAT(events.add(answer(11.0, LocalizationStatus::kPoorFit)),
              ElementsAre("not localized: poor_fit, says localizer_1"));
  for (const double second : {12.0, 13.0}) events.add(frame(second, Quality::kLocalized));
  EXPECT_THAT(events.add(answer(40.0, missed)), IsEmpty()) << "one answer of many";
}

TEST(StateEvents, TellHowManyPlacesAreLeft) {
  StateEvents events;
  RobotOutput output = answer(1.0, LocalizationStatus::kAmbiguous);
  output.answers.front().answer.places = 3;
  EXPECT_THAT(events.add(output),
              ElementsAre("not localized: ambiguous (places: 3), says localizer_1"));
}

TEST(StateEvents, TellAReasonAnewAfterAnAnswerWithAPose) {
  StateEvents events;
  const auto unsure = LocalizationStatus::kUnconfirmed;
  events.add(answer(1.0, unsure));
  EXPECT_THAT(events.add(answer(2.0, LocalizationStatus::kLocalized)), IsEmpty());
  EXPECT_THAT(events.add(answer(3.0, unsure)),
              ElementsAre("not localized: unconfirmed, says localizer_1"));
}

}  // namespace
}  // namespace fleetloc
