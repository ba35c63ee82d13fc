// What live sensors do, but for their clocks.
#include <limits>

#include <gmock/gmock.h>

#include "test/unit/live/live_sensors.hpp"

namespace fleetloc {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

TEST(SensorAssembler, GivesTheImuBeforeTheFrameOfTheSameStamp) {
  LiveSensors sensors;
  sensors.imu(90ms, 0ms);
  sensors.pair(100ms, 5ms);
  EXPECT_THAT(sensors.taken(), ElementsAre("imu 90"));
  sensors.imu(100ms, 10ms);
  sensors.imu(110ms, 20ms);
  EXPECT_THAT(sensors.taken(), ElementsAre("imu 100", "frame 100", "imu 110"));
}

TEST(SensorAssembler, PairsImagesThreeMillisecondsApart) {
  LiveSensors sensors;
  sensors.imu(200ms, 0ms);
  sensors.left(100ms, 1ms);
  sensors.right(103ms, 2ms);
  EXPECT_THAT(sensors.frames(), ElementsAre("frame 100"));
  EXPECT_EQ(sensors.fault("unpaired_images"), 0U);
}

TEST(SensorAssembler, GoesOnWithOneImageWhenThePartnerDoesNotComeInTime) {
  LiveSensors sensors;
  sensors.imu(200ms, 0ms);
  sensors.left(100ms, 0ms);
  sensors.assembler.poll(arriving(49ms));
  EXPECT_THAT(sensors.frames(), IsEmpty());
  sensors.assembler.poll(arriving(50ms));
  EXPECT_THAT(sensors.frames(), ElementsAre("left 100"));
  sensors.right(101ms, 60ms);
  EXPECT_THAT(sensors.frames(), IsEmpty());
  EXPECT_EQ(sensors.fault("unpaired_images"), 1U);
  EXPECT_EQ(sensors.fault("images_late"), 1U);
  EXPECT_THAT(sensors.assembler.take_events(), ElementsAre("/right: images come too late"));
}

TEST(SensorAssembler, HoldsFramesUntilTheImuReachesThemButNotForever) {
  LiveSensors sensors;
  sensors.imu(0ms, 0ms);
  sensors.pair(100ms, 0ms);
  sensors.assembler.poll(arriving(49ms));
  EXPECT_THAT(sensors.frames(), IsEmpty());
  sensors.assembler.poll(arriving(50ms));  // a gap that the odometry may bridge
  EXPECT_THAT(sensors.frames(), ElementsAre("frame 100"));
  sensors.pair(600ms, 100ms);
  sensors.assembler.poll(arriving(150ms));
  EXPECT_THAT(sensors.frames(), IsEmpty());
  EXPECT_EQ(sensors.fault("frames_ahead_of_imu"), 1U);
  EXPECT_THAT(sensors.assembler.take_events(),
              ElementsAre("/left: stamps are 0.6 s ahead of the IMU's"));
}

TEST(SensorAssembler, GivesFramesThatComeLongAfterTheImuAtOnce) {
  LiveSensors sensors;
  sensors.imu(900ms, 0ms);
  sensors.pair(100ms, 1ms);
  EXPECT_THAT(sensors.frames(), ElementsAre("frame 100"));
}

TEST(SensorAssembler, DropsAndCountsWhatIsDoubledOrOutOfOrder) {
  LiveSensors sensors;
  sensors.imu(500ms, 0ms);
  sensors.imu(500ms, 1ms);
  sensors.imu(490ms, 2ms);
  sensors.pair(100ms, 3ms);
  sensors.pair(100ms, 4ms);
  sensors.pair(50ms, 5ms);
  sensors.pair(200ms, 6ms);
  EXPECT_THAT(sensors.taken(), ElementsAre("imu 500", "frame 100", "frame 200"));
  EXPECT_EQ(sensors.fault("imu_doubled"), 1U);
  EXPECT_EQ(sensors.fault("imu_out_of_order"), 1U);
  EXPECT_EQ(sensors.fault("images_doubled"), 2U);
  EXPECT_EQ(sensors.fault("images_out_of_order"), 2U);
}

TEST(SensorAssembler, RefusesZeroStampsAndSaysSoOnce) {
  LiveSensors sensors;
  for (int i = 0; i < 5; ++i) {
    sensors.assembler.add_left(Timestamp{}, image(), arriving(i * 10ms));
    sensors.assembler.add_imu({.stamp = Timestamp{}}, arriving(i * 10ms));
  }
  EXPECT_THAT(sensors.taken(), IsEmpty());
  EXPECT_EQ(sensors.fault("images_zero_stamp"), 5U);
  EXPECT_EQ(sensors.fault("imu_zero_stamp"), 5U);
  EXPECT_THAT(
      sensors.assembler.take_events(),
      ElementsAre("/left: images have no stamps (zero)", "/imu: samples have no stamps (zero)"));
}

TEST(SensorAssembler, LeavesOutImuValuesThatNoSensorMeasures) {
  for (const double impossible : {std::numeric_limits<double>::quiet_NaN(), -1e200, 101.0}) {
    LiveSensors sensors;
    ImuSample broken = sample(10ms);
    broken.angular_velocity.y() = impossible;
    sensors.assembler.add_imu(broken, arriving(0ms));
    sensors.imu(20ms, 10ms);
    EXPECT_THAT(sensors.taken(), ElementsAre("imu 20"));
    EXPECT_EQ(sensors.fault("imu_impossible"), 1U);
    EXPECT_THAT(sensors.assembler.take_events(),
                ElementsAre("/imu: values that are not finite, or beyond 100 rad/s or 1000 m/s^2, "
                            "are left out"));
  }
}

TEST(SensorAssembler, TakesAnImageOfAnotherSizeAsMissingAndSaysEachChangeOnce) {
  LiveSensors sensors({.silence = 2s, .max_frames = 10});
  sensors.imu(990ms, 0ms);
  const auto add = [&](int stamp_ms, int width, int type = CV_8UC1) {
    const Duration arrival = std::chrono::milliseconds(stamp_ms);
    sensors.assembler.add_left(at(arrival), cv::Mat(kHeight, width, type), arriving(arrival));
    sensors.right(arrival, arrival);
  };
  add(100, kWidth);
  add(200, 2 * kWidth);
  add(300, 2 * kWidth);
  add(400, 3 * kWidth);
  add(500, kWidth);
  add(600, kWidth, CV_8UC3);
  EXPECT_THAT(
      sensors.frames(),
      ElementsAre("frame 100", "right 200", "right 300", "right 400", "frame 500", "right 600"));
  EXPECT_EQ(sensors.fault("wrong_images"), 4U);
  EXPECT_THAT(sensors.assembler.take_events(),
              ElementsAre("/left: images of 12x4 pixels are not used: the calibration is for 6x4",
                          "/left: images of 18x4 pixels are not used: the calibration is for 6x4",
                          "/left: images have 6x4 pixels again",
                          "/left: images of 6x4 pixels that are not 8 bit gray are not used"));
}

TEST(SensorAssembler, SaysWithinTwoSecondsThatATopicNeverCame) {
  LiveSensors sensors;
  for (Duration t{}; t < 10s; t += 10ms) {
    sensors.imu(t, t);
    if (t % 100ms == Duration{}) sensors.left(t, t);
    if (t < 2s) {
      EXPECT_THAT(sensors.assembler.take_events(), IsEmpty());
    }
  }
  EXPECT_THAT(sensors.assembler.take_events(),
              ElementsAre("/right: no message has come for 2.0 s"));
  EXPECT_THAT(sensors.assembler.silent_topics(), ElementsAre("/right"));
  EXPECT_EQ(sensors.fault("unpaired_images"), 100U);  // the robot goes on with one camera
  sensors.right(10s, 10s);
  EXPECT_THAT(sensors.assembler.take_events(), ElementsAre("/right: messages come after 10.0 s"));
}

TEST(SensorAssembler, SaysOnceThatATopicStoppedAndOnceThatItIsBack) {
  LiveSensors sensors;
  sensors.run(0s, 5s);
  sensors.frames();
  for (Duration t = 5s; t < 10s; t += 10ms) sensors.pair(t, t);  // without IMU
  EXPECT_THAT(sensors.assembler.take_events(),
              ElementsAre("/imu: no message for 0.5 s", HasSubstr("ahead of the IMU's")));
  sensors.frames();
  sensors.run(10s, 12s);
  EXPECT_THAT(sensors.assembler.take_events(),
              ElementsAre("/imu: messages come again after 5.0 s"));
  EXPECT_THAT(sensors.frames(), SizeIs(4));  // of 20, nobody took them
}

TEST(SensorAssembler, GoesOnAfterACameraThatRestarts) {
  LiveSensors sensors;
  sensors.run(0s, 1s);
  sensors.frames();
  for (Duration t = 1s; t < 6s; t += 10ms) sensors.imu(t, t);
  EXPECT_THAT(sensors.assembler.take_events(),
              ElementsAre("/left: no message for 0.5 s", "/right: no message for 0.5 s"));
  sensors.run(6s, 6300ms);
  EXPECT_THAT(sensors.frames(), ElementsAre("frame 6000", "frame 6100", "frame 6200"));
  EXPECT_THAT(sensors.assembler.take_events(), SizeIs(2));
}

TEST(SensorAssembler, KeepsTheNewestFramesWhenNobodyTakesThem) {
  LiveSensors sensors;
  sensors.run(0s, 10s);
  EXPECT_EQ(sensors.fault("dropped_backlog"), 96U);
  EXPECT_THAT(sensors.frames(),
              ElementsAre("frame 9600", "frame 9700", "frame 9800", "frame 9900"));
  sensors.run(10s, 100s);
  EXPECT_LE(sensors.assembler.held(), 4004U);
  EXPECT_GT(sensors.fault("dropped_imu_backlog"), 0U);
}

TEST(SensorAssembler, AddsTheTimeShiftOfTheCamerasToTheirStamps) {
  LiveSensors sensors({.camera_time_shift = 8ms});
  sensors.imu(108ms, 0ms);
  sensors.pair(100ms, 1ms);
  EXPECT_THAT(sensors.taken(), ElementsAre("imu 108", "frame 108"));
}

}  // namespace
}  // namespace fleetloc
