#include "shared/transport/delay_line.hpp"

#include <future>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace fleetloc {
namespace {

using std::chrono::milliseconds;

TEST(DelayLine, RunsActionsInOrderOfTheirTimesAndNotBeforeThem) {
  DelayLine line;
  const auto start = DelayLine::Clock::now();
  std::vector<int> ran;
  std::promise<DelayLine::Clock::time_point> last;
  line.at(start + milliseconds(40), [&] { last.set_value(DelayLine::Clock::now()); });
  line.at(start + milliseconds(20), [&] { ran.push_back(2); });
  line.at(start + milliseconds(10), [&] { ran.push_back(1); });
  line.at(start + milliseconds(20), [&] { ran.push_back(3); });
  EXPECT_GE(last.get_future().get(), start + milliseconds(40));
  EXPECT_THAT(ran, testing::ElementsAre(1, 2, 3));
}

TEST(DelayLine, ForgetsWhatIsStillToComeWhenItStops) {
  bool ran = false;
  {
    DelayLine line;
    line.at(DelayLine::Clock::now() + milliseconds(20), [&] { ran = true; });
    line.stop();
    line.at(DelayLine::Clock::now(), [&] { ran = true; });
  }
  EXPECT_FALSE(ran);
}

}  // namespace
}  // namespace fleetloc
