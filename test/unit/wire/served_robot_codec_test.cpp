#include "shared/wire/served_robot_codec.hpp"

#include <limits>

#include <idl/monitoring.h>

#include "test/unit/wire/samples.hpp"

namespace fleetloc {
namespace {

ServedRobot some_served_robot() {
  return {.localizer = "localizer_1",
          .robot = "robot_1",
          .session = SessionNumber{7},
          .quality = Quality::kDeadReckoning,
          .T_map_body = Pose{.R = Eigen::Quaterniond(0.5, 0.5, 0.5, 0.5), .p = {1.0, -2.0, 3.0}},
          .covariance = 0.25 * Matrix6d::Identity(),
          .up_bytes_per_s = 1400.0,
          .down_bytes_per_s = 1200.0,
          .silent = std::chrono::milliseconds(500),
          .round_trip = std::chrono::milliseconds(1250),
          .possible_places = {{4.0, 5.0, -6.0}, {40.0, 50.0, 60.0}}};
}

TEST(ServedRobotCodec, RoundTripPreservesIt) {
  const ServedRobot sent = some_served_robot();
  const auto received = decode_served_robot(encode(sent)).value();
  EXPECT_EQ(received.localizer, sent.localizer);
  EXPECT_EQ(received.robot, sent.robot);
  EXPECT_EQ(received.session, sent.session);
  EXPECT_EQ(received.quality, sent.quality);
  ASSERT_TRUE(received.T_map_body);
  EXPECT_LT(local_coordinates(*received.T_map_body, *sent.T_map_body).norm(), 1e-12);
  EXPECT_LT((received.covariance - sent.covariance).norm(), 1e-6);
  EXPECT_EQ(received.up_bytes_per_s, sent.up_bytes_per_s);
  EXPECT_EQ(received.down_bytes_per_s, sent.down_bytes_per_s);
  EXPECT_EQ(received.silent, sent.silent);
  EXPECT_EQ(received.round_trip, sent.round_trip);
  EXPECT_EQ(received.possible_places, sent.possible_places);
}

TEST(ServedRobotCodec, RoundTripPreservesWhatIsNotKnown) {
  ServedRobot sent = some_served_robot();
  sent.T_map_body.reset();
  sent.round_trip.reset();
  const auto received = decode_served_robot(encode(sent)).value();
  EXPECT_FALSE(received.T_map_body);
  EXPECT_FALSE(received.round_trip);
}

TEST(ServedRobotCodec, RefusesWithAReason) {
  const auto expect = [](Malformed reason, const std::function<void(wire::ServedRobot&)>& corrupt) {
    expect_refused<wire::ServedRobot>(some_served_robot(), decode_served_robot, reason, corrupt);
  };
  using enum Malformed;
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  expect(kInvalidId, [](auto& sample) { sample.robot("a/b"); });
  expect(kInvalidId, [](auto& sample) { sample.localizer(""); });
  expect(kNotFinite, [](auto& sample) { sample.up_bytes_per_s(kNaN); });
  expect(kOutOfRange, [](auto& sample) { sample.down_bytes_per_s(-1.0F); });
  expect(kOutOfRange, [](auto& sample) { sample.silent_s(-1.0F); });
  expect(kNotFinite, [](auto& sample) { sample.possible_places()[1].y(kNaN); });
  expect(kOutOfRange, [](auto& sample) { sample.possible_places().resize(17); });
  expect(kNotFinite, [](auto& sample) { sample.covariance().R()[3] = kNaN; });
  expect(kNotFinite, [](auto& sample) { sample.T_map_body().translation().x(kNaN); });
}

}  // namespace
}  // namespace fleetloc
