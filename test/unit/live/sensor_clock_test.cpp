// Clocks that are set while sensors run: all at once, one after the other, one alone.
#include <cmath>
#include <iomanip>
#include <sstream>

#include <gmock/gmock.h>

#include "test/unit/live/live_sensors.hpp"

namespace fleetloc {
namespace {

using namespace std::chrono_literals;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class SensorClock : public testing::TestWithParam<Duration> {
 protected:
  SensorClock() {
    sensors_.run(0s, 2s);
    sensors_.frames();
  }

  LiveSensors sensors_;
};

TEST_P(SensorClock, OfAllSensorsIsFollowedWithAClockStepBeforeTheFirstSample) {
  sensors_.run(2s, 2500ms, GetParam());
  const auto taken = sensors_.taken();
  const auto ms = [&](Duration time) { return std::to_string((time + GetParam()) / 1ms); };
  ASSERT_GT(taken.size(), 2U);
  EXPECT_EQ(taken[0], "clock " + ms(2020ms));  // the third sample confirms it
  EXPECT_EQ(taken[1], "imu " + ms(2020ms));
  EXPECT_THAT(taken, Contains("frame " + ms(2100ms)));
  EXPECT_THAT(taken, Contains("frame " + ms(2400ms)));
  EXPECT_EQ(sensors_.fault("clock_steps"), 1U);
  std::ostringstream by;
  by << (GetParam() < 0s ? "back" : "forward") << " by " << std::fixed << std::setprecision(1)
     << std::abs(to_seconds(GetParam())) << " s";
  EXPECT_THAT(sensors_.assembler.take_events(),
              ElementsAre(HasSubstr("/imu: its clock was set " + by.str())));
}

TEST_P(SensorClock, TellsTheTimeThatWasNotSeen) {
  for (const Duration t : {2500ms, 2510ms, 2520ms}) sensors_.imu(t + GetParam(), t);
  const auto step = std::get<ClockStep>(*sensors_.assembler.take());
  EXPECT_EQ(step.unseen, 2520ms - 1990ms);
}

TEST_P(SensorClock, OfTheCamerasAloneIsSaidAndTheirFramesDroppedUntilItIsRightAgain) {
  for (Duration t = 2s; t < 4s; t += 10ms) {
    sensors_.imu(t, t);
    if (t % 100ms == Duration{}) sensors_.pair(t + GetParam(), t);
  }
  EXPECT_THAT(sensors_.frames(), IsEmpty());
  EXPECT_EQ(sensors_.fault("camera_clock_steps"), 2U);
  EXPECT_EQ(sensors_.fault("clock_steps"), 0U);
  EXPECT_THAT(sensors_.assembler.take_events(),
              ElementsAre(HasSubstr("/left: its clock was set"),
                          HasSubstr("/right: its clock was set"),
                          HasSubstr("/left: stamps are")));
  sensors_.run(4s, 5s);
  EXPECT_THAT(sensors_.frames(), SizeIs(4));  // the newest of eight
}

TEST_P(SensorClock, OfTheImuAloneThenOfTheCamerasIsFollowedAsWell) {
  for (Duration t = 2s; t < 4s; t += 10ms) {
    sensors_.imu(t + GetParam(), t);
    if (t % 100ms == Duration{}) sensors_.pair(t, t);
  }
  EXPECT_THAT(sensors_.frames(), SizeIs(1));  // the clock step
  sensors_.run(4s, 5s, GetParam());
  EXPECT_THAT(sensors_.frames(), SizeIs(4));
  EXPECT_EQ(sensors_.fault("clock_steps"), 1U);
}

TEST_P(SensorClock, IsNotFollowedForOneWrongStamp) {
  sensors_.imu(2s + GetParam(), 2s);
  sensors_.left(2s + GetParam(), 2s);
  sensors_.run(2010ms, 3s);
  EXPECT_THAT(sensors_.frames(), SizeIs(4));
  EXPECT_EQ(sensors_.fault("clock_steps"), 0U);
  EXPECT_EQ(sensors_.fault("imu_unconfirmed"), 1U);
  EXPECT_EQ(sensors_.fault("images_unconfirmed"), 1U);
}

INSTANTIATE_TEST_SUITE_P(Steps, SensorClock, testing::Values(-10s, -2s, 3s, 1h, -24h * 365));

}  // namespace
}  // namespace fleetloc
