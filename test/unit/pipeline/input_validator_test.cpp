#include "robot/pipeline/input_validator.hpp"

#include <limits>

#include <gmock/gmock.h>

namespace fleetloc {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

Timestamp at(Duration time) {
  return Timestamp{time};
}

ImuSample sample_at(Duration stamp) {
  ImuSample sample;
  sample.stamp = at(stamp);
  sample.specific_force.z() = 9.81;
  return sample;
}

std::vector<Duration> admitted(InputValidator& gate, Duration stamp) {
  std::vector<Duration> stamps;
  for (const ImuSample& sample : gate.admit(sample_at(stamp))) {
    stamps.push_back(sample.stamp.time_since_epoch());
  }
  return stamps;
}

TEST(InputValidator, RefusesDoubledDisorderedAndNonFiniteSamplesAndCountsThem) {
  InputValidator gate(500ms);
  EXPECT_THAT(admitted(gate, 10ms), ElementsAre(10ms));
  EXPECT_THAT(admitted(gate, 10ms), IsEmpty());
  EXPECT_THAT(admitted(gate, 5ms), IsEmpty());
  ImuSample broken = sample_at(15ms);
  broken.specific_force.y() = std::numeric_limits<double>::infinity();
  EXPECT_THAT(gate.admit(broken), IsEmpty());
  EXPECT_THAT(admitted(gate, 15ms), ElementsAre(15ms));
  EXPECT_EQ(gate.refused().at("imu_not_newer"), 2U);
  EXPECT_EQ(gate.refused().at("imu_not_finite"), 1U);
}

TEST(InputValidator, LetsSamplesThroughAfterAGapOnceTheNextOneConfirmsIt) {
  InputValidator gate(500ms);
  admitted(gate, 10ms);
  EXPECT_THAT(admitted(gate, 2s), IsEmpty());
  EXPECT_THAT(admitted(gate, 2005ms), ElementsAre(2s, 2005ms));
  EXPECT_THAT(admitted(gate, 2010ms), ElementsAre(2010ms));
  EXPECT_EQ(gate.refused().at("imu_ahead"), 0U);
}

TEST(InputValidator, IsNotLockedOutByOneStampOfTheFuture) {
  InputValidator gate(500ms);
  admitted(gate, 10ms);
  EXPECT_THAT(admitted(gate, 1h), IsEmpty());
  EXPECT_THAT(admitted(gate, 15ms), ElementsAre(15ms));
  EXPECT_THAT(admitted(gate, 20ms), ElementsAre(20ms));
  EXPECT_EQ(gate.refused().at("imu_ahead"), 1U);
  EXPECT_EQ(gate.check_frame(at(1h)), "frame_ahead_of_imu");
  EXPECT_EQ(gate.check_frame(at(30ms)), "");
}

TEST(InputValidator, RefusesFramesThatAreNotNewerOrThatNoImuWillCover) {
  InputValidator gate(500ms);
  EXPECT_EQ(gate.check_frame(at(0ms)), "frame_ahead_of_imu");
  admitted(gate, 10ms);
  EXPECT_EQ(gate.check_frame(at(20ms)), "");
  EXPECT_EQ(gate.check_frame(at(20ms)), "frame_not_newer");
  EXPECT_EQ(gate.check_frame(at(15ms)), "frame_not_newer");
  EXPECT_EQ(gate.check_frame(at(511ms)), "frame_ahead_of_imu");
  EXPECT_EQ(gate.check_frame(at(510ms)), "");
  EXPECT_EQ(gate.refused().at("frame_not_newer"), 2U);
  EXPECT_EQ(gate.refused().at("frame_ahead_of_imu"), 2U);
}

}  // namespace
}  // namespace fleetloc
