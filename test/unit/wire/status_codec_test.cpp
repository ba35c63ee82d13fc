#include "shared/wire/status_codec.hpp"

#include <limits>

#include <idl/status.h>

#include "test/unit/wire/samples.hpp"

namespace fleetloc {
namespace {

TEST(StatusCodec, RoundTripPreservesALocalizerStatus) {
  LocalizerStatus sent = some_localizer_status();
  sent.draining = true;
  const auto received = decode_localizer_status(encode(sent)).value();
  EXPECT_EQ(received.localizer, sent.localizer);
  EXPECT_EQ(received.incarnation, sent.incarnation);
  EXPECT_EQ(received.map_hash, sent.map_hash);
  EXPECT_EQ(received.sessions, sent.sessions);
  EXPECT_EQ(received.load, sent.load);
  EXPECT_EQ(received.accepting, sent.accepting);
  EXPECT_EQ(received.draining, sent.draining);
}

TEST(StatusCodec, RoundTripPreservesARobotStatus) {
  const RobotStatus sent = some_robot_status();
  const auto received = decode_robot_status(encode(sent)).value();
  EXPECT_EQ(received.robot, sent.robot);
  EXPECT_EQ(received.session, sent.session);
  EXPECT_EQ(received.start_stamp, sent.start_stamp);
  EXPECT_EQ(received.stamp, sent.stamp);
  EXPECT_EQ(received.quality, sent.quality);
  EXPECT_EQ(received.submaps_sent, sent.submaps_sent);
  EXPECT_EQ(received.answers_applied, sent.answers_applied);
  EXPECT_EQ(received.round_trip, sent.round_trip);
}

TEST(StatusCodec, RoundTripPreservesTheLackOfARoundTrip) {
  RobotStatus sent = some_robot_status();
  sent.round_trip.reset();
  EXPECT_FALSE(decode_robot_status(encode(sent)).value().round_trip);
}

TEST(StatusCodec, RefusesALocalizerStatusWithAReason) {
  const auto expect_status_refused =
      [](Malformed reason, const std::function<void(wire::LocalizerStatus&)>& corrupt) {
        expect_refused<wire::LocalizerStatus>(
            some_localizer_status(), decode_localizer_status, reason, corrupt);
      };
  using enum Malformed;
  expect_status_refused(kInvalidId, [](auto& sample) { sample.localizer("a/b"); });
  expect_status_refused(kOutOfRange, [](auto& sample) { sample.sessions(4'000'000'000); });
  expect_status_refused(kOutOfRange, [](auto& sample) { sample.load(1.5F); });
  expect_status_refused(kNotFinite,
                        [](auto& sample) { sample.load(std::numeric_limits<float>::quiet_NaN()); });
}

TEST(StatusCodec, RefusesARobotStatusWithAReason) {
  const auto expect_status_refused = [](Malformed reason,
                                        const std::function<void(wire::RobotStatus&)>& corrupt) {
    expect_refused<wire::RobotStatus>(some_robot_status(), decode_robot_status, reason, corrupt);
  };
  using enum Malformed;
  expect_status_refused(kInvalidId, [](auto& sample) { sample.robot(" "); });
  expect_status_refused(kUnknownValue,
                        [](auto& sample) { sample.quality(static_cast<wire::Quality>(5)); });
  expect_status_refused(
      kOutOfRange, [](auto& sample) { sample.stamp_ns(std::numeric_limits<std::int64_t>::max()); });
  expect_status_refused(kOutOfRange, [](auto& sample) {
    sample.start_stamp_ns(std::numeric_limits<std::int64_t>::min());
  });
}

TEST(StatusCodec, TellsWhatItCannotEncode) {
  LocalizerStatus status = some_localizer_status();
  status.sessions = -1;
  EXPECT_THROW(encode(status), NotEncodable);
}

}  // namespace
}  // namespace fleetloc
