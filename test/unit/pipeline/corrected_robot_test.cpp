// Which of the cloud's corrections reach the odometry.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/unit/pipeline/answered_robot.hpp"

namespace fleetloc {
namespace {

class CorrectedRobot : public AnsweredRobot {
 protected:
  CorrectedRobot() { localizer_.correcting = true; }

  [[nodiscard]] std::uint64_t corrections() const {
    const OdometryStatistics& statistics = pipeline_.odometry().statistics();
    return statistics.corrections_applied + statistics.corrections_ignored;
  }
};

TEST_F(CorrectedRobot, TakesThoseOfAnswersThatItUses) {
  play(8.0);
  const std::uint64_t before = corrections();
  EXPECT_GT(before, 3U);
  play(10.0);
  EXPECT_GT(corrections(), before + 3U);
}

TEST_F(CorrectedRobot, TakesNoneOfAnswersThatContradictIt) {
  play(8.0);
  ASSERT_EQ(now_.quality, Quality::kLocalized);
  static_cast<void>(pipeline_.take_answers());
  off_m_ = 3.0;
  play(9.0);  // what was on its way has arrived
  const std::uint64_t before = corrections();
  play(10.5);
  const auto answers = pipeline_.take_answers();
  ASSERT_GT(answers.size(), 4U);
  EXPECT_EQ(name(answers.back().outcome), "gated");
  EXPECT_EQ(corrections(), before);
}

TEST_F(CorrectedRobot, TakesNoneOfAPlaceThatIsTakenBackInTheSameMoment) {
  play(8.0);
  localizer_.status = LocalizationStatus::kLost;
  play(9.0);  // what was on its way has arrived
  const std::uint64_t before = corrections();
  play(10.5);
  EXPECT_EQ(corrections(), before);
}

TEST_F(CorrectedRobot, TakesNoneThatIsOfThePlaceBeforeItWasPlaced) {
  play(8.0);
  localizer_.answering = false;
  localizer_.correcting = false;
  play(9.0);
  const std::uint64_t before = corrections();
  localizer_.correction = of_unknown_landmark(KeyframeId{4'000'000'000});
  pipeline_.poll(now_.stamp);
  pipeline_.place({.stamp = now_.stamp, .T_map_body = truth(9.0)});
  play(10.0);
  EXPECT_EQ(corrections(), before);
}

}  // namespace
}  // namespace fleetloc
