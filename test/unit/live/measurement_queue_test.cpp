#include "robot/live/measurement_queue.hpp"

#include <gtest/gtest.h>

#include "test/unit/live/live_sensors.hpp"

namespace fleetloc {
namespace {

using namespace std::chrono_literals;

StereoFrame frame(Duration stamp) {
  StereoFrame frame;
  frame.stamp = at(stamp);
  return frame;
}

TEST(MeasurementQueue, DropsTheOldestFramesAndNoImuBetween) {
  MeasurementQueue queue(2, 100);
  for (int i = 0; i < 5; ++i) {
    queue.push(sample(i * 1s));
    queue.push(CameraFrame(frame(i * 1s)));
  }
  EXPECT_EQ(queue.dropped_frames(), 3U);
  EXPECT_EQ(queue.size(), 7U);
  std::vector<Timestamp> frames;
  while (const auto taken = queue.take()) {
    if (std::holds_alternative<CameraFrame>(*taken)) frames.push_back(stamp_of(*taken));
  }
  EXPECT_EQ(frames, (std::vector{at(3s), at(4s)}));
}

TEST(MeasurementQueue, DropsTheOldestImuSamplesLast) {
  MeasurementQueue queue(2, 3);
  for (int i = 0; i < 10; ++i) queue.push(sample(i * 1s));
  EXPECT_EQ(queue.dropped_imu(), 7U);
  EXPECT_EQ(stamp_of(*queue.take()), at(7s));
}

TEST(MeasurementQueue, KeepsOneClockStepAndWhatFollowsIt) {
  MeasurementQueue queue(2, 10);
  queue.push(sample(1s));
  queue.push(ClockStep{at(-1h), 1s});
  queue.push(sample(-1h));
  queue.push(CameraFrame(frame(-1h)));
  queue.push(ClockStep{at(2h), 2s});
  queue.push(sample(2h));
  EXPECT_EQ(queue.size(), 3U);
  EXPECT_EQ(queue.dropped_imu(), 1U);
  EXPECT_EQ(queue.dropped_frames(), 1U);
  queue.take();
  const auto step = std::get<ClockStep>(*queue.take());
  EXPECT_EQ(step.stamp, at(2h));
  EXPECT_EQ(step.unseen, 3s);
}

}  // namespace
}  // namespace fleetloc
