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

std::vector<Duration> accepted(InputValidator& validator, Duration stamp) {
  std::vector<Duration> stamps;
  for (const ImuSample& sample : validator.check_imu(sample_at(stamp)).value_or(kNothing)) {
    stamps.push_back(sample.stamp.time_since_epoch());
  }
  return stamps;
}

/// Why a frame is rejected; empty if it is accepted.
std::string_view why_not(InputValidator& validator, Duration stamp) {
  const auto checked = validator.check_frame(at(stamp));
  return checked ? std::string_view() : name(checked.error());
}

TEST(InputValidator, RejectsDoubledDisorderedAndImpossibleSamplesAndCountsThem) {
  InputValidator validator(500ms);
  EXPECT_THAT(accepted(validator, 10ms), ElementsAre(10ms));
  EXPECT_THAT(accepted(validator, 10ms), IsEmpty());
  EXPECT_THAT(accepted(validator, 5ms), IsEmpty());
  ImuSample broken = sample_at(15ms);
  broken.specific_force.y() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(validator.check_imu(broken).error(), InputRejection::kImuImpossible);
  broken.specific_force.y() = -1e200;
  EXPECT_EQ(validator.check_imu(broken).error(), InputRejection::kImuImpossible);
  EXPECT_THAT(accepted(validator, 15ms), ElementsAre(15ms));
  EXPECT_EQ(validator.rejected().at("imu_not_newer"), 2U);
  EXPECT_EQ(validator.rejected().at("imu_impossible"), 2U);
}

TEST(InputValidator, LetsSamplesThroughAfterAGapOnceTheNextOneConfirmsIt) {
  InputValidator validator(500ms);
  accepted(validator, 10ms);
  EXPECT_EQ(validator.check_imu(sample_at(2s)).error(), InputRejection::kImuAhead);
  EXPECT_THAT(accepted(validator, 2005ms), ElementsAre(2s, 2005ms));
  EXPECT_THAT(accepted(validator, 2010ms), ElementsAre(2010ms));
  EXPECT_EQ(validator.rejected().at("imu_ahead"), 0U);
}

TEST(InputValidator, IsNotLockedOutByOneStampOfTheFuture) {
  InputValidator validator(500ms);
  accepted(validator, 10ms);
  EXPECT_THAT(accepted(validator, 1h), IsEmpty());
  EXPECT_THAT(accepted(validator, 15ms), ElementsAre(15ms));
  EXPECT_THAT(accepted(validator, 20ms), ElementsAre(20ms));
  EXPECT_EQ(validator.rejected().at("imu_ahead"), 1U);
  EXPECT_EQ(why_not(validator, 1h), "frame_ahead_of_imu");
  EXPECT_EQ(why_not(validator, 30ms), "");
}

TEST(InputValidator, RejectsFramesThatAreNotNewerOrThatNoImuWillCover) {
  InputValidator validator(500ms);
  EXPECT_EQ(why_not(validator, 0ms), "frame_ahead_of_imu");
  accepted(validator, 10ms);
  EXPECT_EQ(why_not(validator, 20ms), "");
  EXPECT_EQ(why_not(validator, 20ms), "frame_not_newer");
  EXPECT_EQ(why_not(validator, 15ms), "frame_not_newer");
  EXPECT_EQ(why_not(validator, 511ms), "frame_ahead_of_imu");
  EXPECT_EQ(why_not(validator, 510ms), "");
  EXPECT_EQ(validator.rejected().at("frame_not_newer"), 2U);
  EXPECT_EQ(validator.rejected().at("frame_ahead_of_imu"), 2U);
}

}  // namespace
}  // namespace fleetloc
