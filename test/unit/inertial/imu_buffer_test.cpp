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

// A rate of 1 rad/s before, 2 after, none between.
class ImuBufferAtAStandstill : public testing::Test {
 protected:
  void SetUp() override {
    for (int i = 0; i <= 100; ++i) {
      const double rate = i < 20 ? 1.0 : i < 80 ? 0.0 : 2.0;
      ASSERT_TRUE(buffer_.add({at(i * 10ms), {rate, 0.0, 0.0}, Eigen::Vector3d::Zero()}));
    }
  }
  /// By the trapezoidal rule [rad]; stamps must increase.
  static double turned(const std::vector<ImuSample>& samples) {
    double sum = 0.0;
    for (std::size_t i = 1; i < samples.size(); ++i) {
      EXPECT_LT(samples[i - 1].stamp, samples[i].stamp);
      sum += 0.5 * to_seconds(samples[i].stamp - samples[i - 1].stamp) *
             (samples[i - 1].angular_velocity.x() + samples[i].angular_velocity.x());
    }
    return sum;
  }
  ImuBuffer buffer_;
};

TEST_F(ImuBufferAtAStandstill, JoinsWhatCameBeforeToWhatComesAfter) {
  const double whole = turned(buffer_.between(at(55ms), at(995ms)));
  buffer_.leave_out(at(303ms), at(604ms));
  const std::vector<ImuSample> samples = buffer_.between(at(55ms), at(995ms));
  EXPECT_NEAR(turned(samples), whole, 1e-12);
  EXPECT_EQ(samples.back().stamp, at(995ms));
  EXPECT_EQ(samples.back().stamp - samples.front().stamp, 940ms - 301ms);
  EXPECT_EQ(buffer_.left_out(at(55ms), at(995ms)), 301ms);
  EXPECT_EQ(buffer_.left_out(at(604ms), at(995ms)), 0ms);
}

TEST_F(ImuBufferAtAStandstill, LetsItGoOn) {
  const double whole = turned(buffer_.between(at(55ms), at(995ms)));
  for (int end = 310; end <= 700; end += 10) buffer_.leave_out(at(303ms), at(end * 1ms));
  EXPECT_NEAR(turned(buffer_.between(at(55ms), at(995ms))), whole, 1e-12);
  EXPECT_EQ(buffer_.left_out(at(0ms), at(1000ms)), 397ms);
}

TEST_F(ImuBufferAtAStandstill, BeginsAfterItIfAskedFromWithinIt) {
  buffer_.leave_out(at(300ms), at(600ms));
  EXPECT_TRUE(buffer_.covers(at(450ms)));
  const std::vector<ImuSample> samples = buffer_.between(at(450ms), at(700ms));
  ASSERT_FALSE(samples.empty());
  EXPECT_EQ(samples.front().stamp, at(600ms));
}

// As after the keyframe in which the body came to rest has entered the window.
TEST_F(ImuBufferAtAStandstill, CoversItsBeginAfterForgettingWhatCameBefore) {
  buffer_.leave_out(at(300ms), at(600ms));
  buffer_.forget_before(at(300ms));
  EXPECT_TRUE(buffer_.covers(at(300ms)));
  EXPECT_EQ(buffer_.between(at(300ms), at(700ms)).size(), 11U);
  buffer_.leave_out(at(300ms), at(650ms));
  EXPECT_EQ(buffer_.between(at(300ms), at(700ms)).size(), 6U);
}

TEST_F(ImuBufferAtAStandstill, KeepsWhatCameBeforeHoweverLongItLasts) {
  for (int i = 101; i <= 10000; ++i) {
    ASSERT_TRUE(buffer_.add({at(i * 10ms), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()}));
    buffer_.leave_out(at(950ms), at(i * 10ms - 50ms));
    buffer_.keep(900ms);
  }
  EXPECT_TRUE(buffer_.covers(at(110ms)));
  EXPECT_FALSE(buffer_.covers(at(0ms)));
  EXPECT_LT(buffer_.between(at(110ms), at(100s)).size(), 110U);
  buffer_.forget_before(at(99'990ms));
  EXPECT_TRUE(buffer_.begins_after(at(900ms)));
}

}  // namespace
}  // namespace fleetloc
