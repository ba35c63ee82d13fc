#include "robot/live/stamp_gate.hpp"

#include <gtest/gtest.h>

#include "test/unit/live/live_sensors.hpp"

namespace fleetloc {
namespace {

using namespace std::chrono_literals;

std::string_view why_not(StampGate& gate, Duration stamp, Duration arrival) {
  const auto accepted = gate.check(at(stamp), arriving(arrival));
  if (!accepted) return name(accepted.error());
  return accepted->step ? "step" : "";
}

TEST(StampGate, RefusesDoubledLateAndZeroStampsByName) {
  StampGate gate;
  EXPECT_EQ(name(gate.check(Timestamp{}, arriving(0ms)).error()), "zero_stamp");
  EXPECT_EQ(name(gate.check(Timestamp{-5s}, arriving(0ms)).error()), "zero_stamp");
  EXPECT_EQ(why_not(gate, 100ms, 0ms), "");
  EXPECT_EQ(why_not(gate, 100ms, 10ms), "doubled");
  EXPECT_EQ(why_not(gate, 90ms, 20ms), "out_of_order");
  EXPECT_EQ(why_not(gate, 110ms, 30ms), "");
}

TEST(StampGate, DoesNotTakeOneWrongStampForASetClock) {
  StampGate gate;
  EXPECT_EQ(why_not(gate, 0ms, 0ms), "");
  EXPECT_EQ(why_not(gate, 1h, 10ms), "unconfirmed");
  EXPECT_EQ(why_not(gate, 20ms, 20ms), "");
  EXPECT_EQ(why_not(gate, -1h, 30ms), "unconfirmed");
  EXPECT_EQ(why_not(gate, 1h, 40ms), "unconfirmed");
  EXPECT_EQ(why_not(gate, 50ms, 50ms), "");
}

TEST(StampGate, TellsByHowMuchAClockWasSetOnceTwoMoreStampsGoOnFromIt) {
  for (const Duration step : {Duration(-10s), Duration(1h)}) {
    StampGate gate;
    why_not(gate, 0ms, 0ms);
    EXPECT_EQ(why_not(gate, step + 10ms, 10ms), "unconfirmed");
    EXPECT_EQ(why_not(gate, step + 20ms, 20ms), "unconfirmed");
    const auto accepted = gate.check(at(step + 30ms), arriving(30ms));
    ASSERT_TRUE(accepted && accepted->step);
    EXPECT_EQ(*accepted->step, step);
    EXPECT_EQ(accepted->unseen, 30ms);
    EXPECT_EQ(why_not(gate, step + 40ms, 40ms), "");
  }
}

TEST(StampGate, TakesNeitherAPauseNorADelayForASetClock) {
  StampGate gate;
  EXPECT_EQ(why_not(gate, 0s, 0s), "");
  EXPECT_EQ(why_not(gate, 1h, 1h), "");         // the sensor paused
  EXPECT_EQ(why_not(gate, 1h + 10ms, 2h), "");  // the message was late
  EXPECT_EQ(why_not(gate, 2h + 10ms, 2h + 1s), "unconfirmed");
}

}  // namespace
}  // namespace fleetloc
