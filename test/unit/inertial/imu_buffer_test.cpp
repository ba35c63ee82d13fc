#include "robot/inertial/imu_buffer.hpp"

#include <limits>

#include <gmock/gmock.h>

namespace fleetloc {
namespace {

using namespace std::chrono_literals;

Timestamp at(Duration time) {
  return Timestamp{time};
}

// Both readings grow linearly, so that interpolation is exact.
ImuSample sample_at(Duration time) {
  const double t = to_seconds(time);
  return {at(time), {t, 2.0 * t, 3.0 * t}, {4.0 * t, 5.0 * t, 6.0 * t}};
}

ImuBuffer filled() {
  ImuBuffer buffer;
  for (const Duration time : {10ms, 15ms, 20ms, 30ms}) {
    EXPECT_TRUE(buffer.add(sample_at(time)));
  }
  return buffer;
}

std::vector<Duration> times(const std::vector<ImuSample>& samples) {
  std::vector<Duration> result;
  for (const ImuSample& sample : samples) {
    result.push_back(sample.stamp.time_since_epoch());
    const ImuSample expected = sample_at(result.back());
    EXPECT_LT((sample.angular_velocity - expected.angular_velocity).norm(), 1e-12);
    EXPECT_LT((sample.specific_force - expected.specific_force).norm(), 1e-12);
  }
  return result;
}

TEST(ImuBuffer, RefusesDoubledAndDisorderedStamps) {
  ImuBuffer buffer = filled();
  EXPECT_FALSE(buffer.add(sample_at(30ms)));
  EXPECT_FALSE(buffer.add(sample_at(12ms)));
  EXPECT_TRUE(buffer.add(sample_at(31ms)));
  EXPECT_EQ(buffer.between(at(10ms), at(31ms)).size(), 5U);
}

TEST(ImuBuffer, RefusesWhatIsNotFinite) {
  ImuBuffer buffer = filled();
  ImuSample broken = sample_at(31ms);
  broken.angular_velocity.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(buffer.add(broken));
  broken = sample_at(31ms);
  broken.specific_force.z() = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(buffer.add(broken));
  EXPECT_FALSE(buffer.covers(at(31ms)));
}

TEST(ImuBuffer, KnowsWhatItWillNeverCover) {
  EXPECT_FALSE(ImuBuffer().begins_after(at(0ms)));
  EXPECT_TRUE(filled().begins_after(at(9ms)));
  EXPECT_FALSE(filled().begins_after(at(10ms)));
  EXPECT_FALSE(filled().begins_after(at(40ms)));
}

TEST(ImuBuffer, InterpolatesBothEnds) {
  const ImuBuffer buffer = filled();
  EXPECT_THAT(times(buffer.between(at(12ms), at(26ms))),
              testing::ElementsAre(12ms, 15ms, 20ms, 26ms));
  EXPECT_THAT(times(buffer.between(at(21ms), at(29ms))), testing::ElementsAre(21ms, 29ms));
}

TEST(ImuBuffer, DoublesNoSampleAtItsEnds) {
  const ImuBuffer buffer = filled();
  EXPECT_THAT(times(buffer.between(at(10ms), at(30ms))),
              testing::ElementsAre(10ms, 15ms, 20ms, 30ms));
  EXPECT_THAT(times(buffer.between(at(15ms), at(20ms))), testing::ElementsAre(15ms, 20ms));
  EXPECT_THAT(times(buffer.between(at(20ms), at(20ms))), testing::ElementsAre(20ms));
  EXPECT_THAT(times(buffer.between(at(17ms), at(17ms))), testing::ElementsAre(17ms));
}

TEST(ImuBuffer, GivesNothingBeyondWhatItCovers) {
  const ImuBuffer buffer = filled();
  EXPECT_THAT(buffer.between(at(9ms), at(20ms)), testing::IsEmpty());
  EXPECT_THAT(buffer.between(at(20ms), at(31ms)), testing::IsEmpty());
  EXPECT_THAT(buffer.between(at(20ms), at(15ms)), testing::IsEmpty());
  EXPECT_THAT(ImuBuffer().between(at(0ms), at(0ms)), testing::IsEmpty());
  EXPECT_FALSE(ImuBuffer().covers(at(0ms)));
  EXPECT_FALSE(buffer.covers(at(9ms)));
  EXPECT_TRUE(buffer.covers(at(10ms)));
  EXPECT_TRUE(buffer.covers(at(30ms)));
  EXPECT_FALSE(buffer.covers(at(31ms)));
}

TEST(ImuBuffer, KeepsOneSampleForInterpolationWhenItForgets) {
  ImuBuffer buffer = filled();
  buffer.forget_before(at(17ms));
  EXPECT_FALSE(buffer.covers(at(14ms)));
  EXPECT_THAT(times(buffer.between(at(17ms), at(20ms))), testing::ElementsAre(17ms, 20ms));
  buffer.forget_before(at(20ms));
  EXPECT_TRUE(buffer.covers(at(20ms)));
  EXPECT_FALSE(buffer.covers(at(19ms)));
  buffer.forget_before(at(100ms));
  EXPECT_TRUE(buffer.covers(at(30ms)));
  EXPECT_FALSE(buffer.add(sample_at(25ms)));
}

}  // namespace
}  // namespace fleetloc
