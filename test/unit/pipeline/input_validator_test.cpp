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

const std::vector<ImuSample> kNothing;

std::vector<Duration> admitted(InputValidator& gate, Duration stamp) {
  std::vector<Duration> stamps;
  for (const ImuSample& sample : gate.check_imu(sample_at(stamp)).value_or(kNothing)) {
    stamps.push_back(sample.stamp.time_since_epoch());
  }
  return stamps;
}

/// Why a frame is rejected; empty if it is accepted.
std::string_view why_not(InputValidator& gate, Duration stamp) {
  const auto accepted = gate.check_frame(at(stamp));
  return accepted ? std::string_view() : name(accepted.error());
}

TEST(InputValidator, RefusesDoubledDisorderedAndNonFiniteSamplesAndCountsThem) {
  InputValidator gate(500ms);
  EXPECT_THAT(admitted(gate, 10ms), ElementsAre(10ms));
  EXPECT_THAT(admitted(gate, 10ms), IsEmpty());
  EXPECT_THAT(admitted(gate, 5ms), IsEmpty());
  ImuSample broken = sample_at(15ms);
  broken.specific_force.y() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(gate.check_imu(broken).error(), InputRejection::kImuNotFinite);
  EXPECT_THAT(admitted(gate, 15ms), ElementsAre(15ms));
  EXPECT_EQ(gate.rejected().at("imu_not_newer"), 2U);
  EXPECT_EQ(gate.rejected().at("imu_not_finite"), 1U);
}

TEST(InputValidator, LetsSamplesThroughAfterAGapOnceTheNextOneConfirmsIt) {
  InputValidator gate(500ms);
  admitted(gate, 10ms);
  EXPECT_EQ(gate.check_imu(sample_at(2s)).error(), InputRejection::kImuAhead);
  EXPECT_THAT(admitted(gate, 2005ms), ElementsAre(2s, 2005ms));
  EXPECT_THAT(admitted(gate, 2010ms), ElementsAre(2010ms));
  EXPECT_EQ(gate.rejected().at("imu_ahead"), 0U);
}

TEST(InputValidator, IsNotLockedOutByOneStampOfTheFuture) {
  InputValidator gate(500ms);
  admitted(gate, 10ms);
  EXPECT_THAT(admitted(gate, 1h), IsEmpty());
  EXPECT_THAT(admitted(gate, 15ms), ElementsAre(15ms));
  EXPECT_THAT(admitted(gate, 20ms), ElementsAre(20ms));
  EXPECT_EQ(gate.rejected().at("imu_ahead"), 1U);
  EXPECT_EQ(why_not(gate, 1h), "frame_ahead_of_imu");
  EXPECT_EQ(why_not(gate, 30ms), "");
}

TEST(InputValidator, RefusesFramesThatAreNotNewerOrThatNoImuWillCover) {
  InputValidator gate(500ms);
  EXPECT_EQ(why_not(gate, 0ms), "frame_ahead_of_imu");
  admitted(gate, 10ms);
  EXPECT_EQ(why_not(gate, 20ms), "");
  EXPECT_EQ(why_not(gate, 20ms), "frame_not_newer");
  EXPECT_EQ(why_not(gate, 15ms), "frame_not_newer");
  EXPECT_EQ(why_not(gate, 511ms), "frame_ahead_of_imu");
  EXPECT_EQ(why_not(gate, 510ms), "");
  EXPECT_EQ(gate.rejected().at("frame_not_newer"), 2U);
  EXPECT_EQ(gate.rejected().at("frame_ahead_of_imu"), 2U);
}

}  // namespace
}  // namespace fleetloc
