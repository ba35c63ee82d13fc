#include "shared/wire/session_codec.hpp"

#include <limits>

#include <idl/session.h>

#include "test/unit/wire/samples.hpp"

namespace fleetloc {
namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

void expect_session_refused(Malformed reason,
                            const std::function<void(wire::RobotSession&)>& corrupt) {
  expect_refused<wire::RobotSession>(some_session(), decode_robot_session, reason, corrupt);
}

TEST(SessionCodec, RoundTripPreservesEveryField) {
  const RobotSession sent = some_session();
  const auto received = decode_robot_session(encode(sent)).value();
  EXPECT_EQ(received.robot, sent.robot);
  EXPECT_EQ(received.session, sent.session);
  EXPECT_EQ(received.start_stamp, sent.start_stamp);
  EXPECT_EQ(received.localizer, sent.localizer);
  EXPECT_EQ(received.incarnation, sent.incarnation);
  EXPECT_EQ(received.encoding, sent.encoding);
  EXPECT_EQ(received.stereo.focal_px, sent.stereo.focal_px);
  EXPECT_EQ(received.stereo.center_px, sent.stereo.center_px);
  EXPECT_EQ(received.stereo.baseline_m, sent.stereo.baseline_m);
  expect_near(received.stereo.T_body_cam0, sent.stereo.T_body_cam0, 1e-15, 0.0);
  ASSERT_TRUE(received.start);
  expect_near(received.start->T_map_odom, sent.start->T_map_odom, 1e-15, 0.0);
  expect_near(received.start->covariance, sent.start->covariance, 1e-6);
}

// The compact encoding predicts from it, at both ends alike.
TEST(SessionCodec, RoundTripPreservesTheBitsOfTheCalibration) {
  for (int i = 0; i < 1000; ++i) {
    RobotSession sent = some_session();
    sent.stereo.T_body_cam0 = some_pose(0.01 * i);
    const auto received = decode_robot_session(encode(sent)).value();
    EXPECT_EQ(received.stereo.T_body_cam0.R.coeffs(), sent.stereo.T_body_cam0.R.coeffs()) << i;
  }
}

TEST(SessionCodec, RoundTripPreservesTheLackOfAStart) {
  RobotSession sent = some_session();
  sent.start.reset();
  sent.encoding = SubmapEncoding::kCompact;
  sent.region = StartRegion{.name = "hall_B", .p_odom = {1.0, -2.0, 3.0}};
  const auto received = decode_robot_session(encode(sent)).value();
  EXPECT_FALSE(received.start);
  EXPECT_EQ(received.encoding, SubmapEncoding::kCompact);
  ASSERT_TRUE(received.region);
  EXPECT_EQ(received.region->name, "hall_B");
  EXPECT_EQ(received.region->p_odom, sent.region->p_odom);
  sent.region = StartRegion{.center_map = {10.0, -20.0}, .radius_m = 30.0};
  const auto in_circle = decode_robot_session(encode(sent)).value();
  ASSERT_TRUE(in_circle.region);
  EXPECT_EQ(in_circle.region->center_map, sent.region->center_map);
  EXPECT_EQ(in_circle.region->radius_m, 30.0);
  sent.region.reset();
  EXPECT_FALSE(decode_robot_session(encode(sent)).value().region);
}

TEST(SessionCodec, RefusesWithAReason) {
  using enum Malformed;
  expect_session_refused(kInvalidId, [](auto& sample) { sample.localizer("a b"); });
  expect_session_refused(kInvalidId, [](auto& sample) { sample.region("a b"); });
  expect_session_refused(kOutOfRange, [](auto& sample) { sample.region_circle()[2] = -1.0; });
  expect_session_refused(kNotFinite, [](auto& sample) { sample.region_circle()[0] = kNotANumber; });
  expect_session_refused(
      kUnknownValue, [](auto& sample) { sample.encoding(static_cast<wire::SubmapEncoding>(2)); });
  expect_session_refused(kOutOfRange, [](auto& sample) { sample.focal_px(0.0); });
  expect_session_refused(kNotFinite, [](auto& sample) { sample.center_px()[1] = kNotANumber; });
  expect_session_refused(kOutOfRange, [](auto& sample) { sample.baseline_m(-0.1); });
  expect_session_refused(kOutOfRange, [](auto& sample) {
    sample.start_stamp_ns(std::numeric_limits<std::int64_t>::max());
  });
  expect_session_refused(kNotARotation, [](auto& sample) { sample.T_body_cam0().rotation().w(3); });
  expect_session_refused(kNotFinite,
                         [](auto& sample) { sample.T_map_odom().rotation().w(kNotANumber); });
  expect_session_refused(kOutOfRange,
                         [](auto& sample) { sample.T_map_odom().translation().x(1e9); });
  expect_session_refused(kOutOfRange, [](auto& sample) { sample.covariance().R()[20] = 1e20F; });
}

TEST(SessionCodec, TellsWhatItCannotEncode) {
  RobotSession session = some_session();
  session.localizer = "a-name-of-more-than-32-characters";
  EXPECT_THROW(encode(session), NotEncodable);
  session = some_session();
  session.region = StartRegion{.name = "hall B"};
  EXPECT_THROW(encode(session), NotEncodable);
  session = some_session();
  session.start->covariance(0, 1) += 1e6;
  EXPECT_THROW(encode(session), NotEncodable);
  session = some_session();
  session.start->covariance = -session.start->covariance;
  EXPECT_THROW(encode(session), NotEncodable);
}

}  // namespace
}  // namespace fleetloc
