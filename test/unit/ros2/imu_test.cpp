#include <functional>
#include <limits>

#include "test/unit/ros2/samples.hpp"

namespace fleetloc {
namespace {

using sensor_msgs::msg::dds_::Imu_;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

void expect_imu_refused(std::string_view reason, const std::function<void(Imu_&)>& corrupt) {
  Imu_ imu = from_ros2_cdr<Imu_>(encode(some_imu())).value();
  corrupt(imu);
  expect_refused(decode_imu(to_cdr(imu)), reason);
}

TEST(Ros2Imu, RoundTripPreservesEveryField) {
  const ImuMessage sent = some_imu();
  const ImuMessage received = decode_imu(encode(sent)).value();
  EXPECT_EQ(received.frame, sent.frame);
  EXPECT_EQ(received.sample.stamp, sent.sample.stamp);
  EXPECT_EQ(received.sample.angular_velocity, sent.sample.angular_velocity);
  EXPECT_EQ(received.sample.specific_force, sent.sample.specific_force);
}

TEST(Ros2Imu, SaysThatItHasNoOrientation) {
  const auto imu = from_ros2_cdr<Imu_>(encode(some_imu())).value();
  EXPECT_EQ(imu.orientation_covariance()[0], -1.0);
  EXPECT_EQ(imu.angular_velocity_covariance(), (std::array<double, 9>{}));
  EXPECT_EQ(imu.linear_acceleration_covariance(), (std::array<double, 9>{}));
}

TEST(Ros2Imu, WhatIsNotFiniteIsRefused) {
  for (const double value : {kNaN, kInfinity, -kInfinity}) {
    expect_imu_refused("not_finite", [&](Imu_& imu) { imu.angular_velocity().y(value); });
    expect_imu_refused("not_finite", [&](Imu_& imu) { imu.linear_acceleration().z(value); });
  }
}

TEST(Ros2Imu, AFaultyDriverCanBePlayed) {
  ImuMessage imu = some_imu();
  imu.sample.specific_force.x() = kNaN;
  expect_refused(decode_imu(encode(imu)), "not_finite");
}

TEST(Ros2Imu, ImpossibleMotionIsRefused) {
  expect_imu_refused("out_of_range", [](Imu_& imu) { imu.angular_velocity().x(1001.0); });
  expect_imu_refused("out_of_range", [](Imu_& imu) { imu.linear_acceleration().x(1e300); });
}

TEST(Ros2Imu, OneThatDoesNotMeasureIsRefused) {
  const std::array<double, 9> none{-1.0};
  expect_imu_refused("not_measured", [&](Imu_& imu) { imu.angular_velocity_covariance(none); });
  expect_imu_refused("not_measured", [&](Imu_& imu) { imu.linear_acceleration_covariance(none); });
}

TEST(Ros2Imu, StampsBefore1970AndOfTooManyNanosecondsAreRefused) {
  expect_imu_refused("invalid_stamp", [](Imu_& imu) { imu.header().stamp().sec(-1); });
  expect_imu_refused("invalid_stamp",
                     [](Imu_& imu) { imu.header().stamp().nanosec(1'000'000'000); });
}

TEST(Ros2Imu, ALongFrameIsRefused) {
  expect_imu_refused("long_text", [](Imu_& imu) { imu.header().frame_id(std::string(257, 'a')); });
}

TEST(Ros2Imu, AStampThatRos2CannotSayBecomesTheNearest) {
  ImuMessage imu = some_imu();
  imu.sample.stamp = Timestamp(Duration(-1));
  EXPECT_EQ(decode_imu(encode(imu)).value().sample.stamp, Timestamp());
  imu.sample.stamp = Timestamp::max();
  EXPECT_EQ(decode_imu(encode(imu)).value().sample.stamp,
            Timestamp(Duration(2'147'483'647'999'999'999)));
}

}  // namespace
}  // namespace fleetloc
