#include "shared/wire/localization_result_codec.hpp"

#include <limits>

#include <idl/localization.h>

#include "test/unit/wire/samples.hpp"

namespace fleetloc {
namespace {

void expect_answer_refused(Malformed reason,
                           const std::function<void(wire::LocalizationResult&)>& corrupt) {
  expect_refused<wire::LocalizationResult>(
      some_answer(), decode_localization_result, reason, corrupt);
}

TEST(LocalizationResultCodec, RoundTripPreservesEveryField) {
  const LocalizationResult sent = some_answer();
  const auto received = decode_localization_result(encode(sent)).value();
  EXPECT_EQ(received.robot, sent.robot);
  EXPECT_EQ(received.session, sent.session);
  EXPECT_EQ(received.localizer, sent.localizer);
  EXPECT_EQ(received.incarnation, sent.incarnation);
  EXPECT_EQ(received.acknowledgements.base, sent.acknowledgements.base);
  EXPECT_EQ(received.acknowledgements.bitmap, sent.acknowledgements.bitmap);
  EXPECT_EQ(received.status, sent.status);
  EXPECT_EQ(received.keyframe, sent.keyframe);
  EXPECT_EQ(received.revision, sent.revision);
  EXPECT_EQ(received.stamp, sent.stamp);
  EXPECT_EQ(received.oldest_stamp, sent.oldest_stamp);
  EXPECT_EQ(received.map_hash, sent.map_hash);
  expect_near(received.T_map_body, sent.T_map_body, 1e-15, 0.0);
  expect_near(received.covariance, sent.covariance, 1e-6);
  expect_near(received.T_map_odom, sent.T_map_odom, 1e-15, 0.0);
  EXPECT_EQ(received.holding_time, sent.holding_time);
}

TEST(LocalizationResultCodec, RoundTripPreservesEveryStatus) {
  for (int status = 0; status <= static_cast<int>(LocalizationStatus::kUnconfirmed); ++status) {
    LocalizationResult sent = some_answer();
    sent.status = static_cast<LocalizationStatus>(status);
    EXPECT_EQ(decode_localization_result(encode(sent)).value().status, sent.status);
  }
}

TEST(LocalizationResultCodec, ARejectionHasNoPose) {
  LocalizationResult sent = some_answer();
  sent.status = LocalizationStatus::kPoorFit;
  sent.covariance.setConstant(std::numeric_limits<double>::quiet_NaN());
  const auto received = decode_localization_result(encode(sent)).value();
  EXPECT_TRUE(received.T_map_body.p.isZero());
  EXPECT_TRUE(received.covariance.isZero());
  EXPECT_EQ(received.oldest_stamp, received.stamp);
}

TEST(LocalizationResultCodec, RefusesWithAReason) {
  using enum Malformed;
  expect_answer_refused(kInvalidId, [](auto& sample) { sample.robot("?"); });
  expect_answer_refused(kInvalidId, [](auto& sample) { sample.localizer(""); });
  expect_answer_refused(kUnknownValue, [](auto& sample) {
    sample.status(static_cast<wire::LocalizationStatus>(10));
  });
  expect_answer_refused(
      kOutOfRange, [](auto& sample) { sample.stamp_ns(std::numeric_limits<std::int64_t>::min()); });
  expect_answer_refused(kOutOfRange, [](auto& sample) {
    sample.oldest_stamp_ns(std::numeric_limits<std::int64_t>::min());
  });
  expect_answer_refused(kUnorderedStamps,
                        [](auto& sample) { sample.oldest_stamp_ns(sample.stamp_ns() + 1); });
  expect_answer_refused(kOutOfRange, [](auto& sample) { sample.holding_time_ns(-1); });
  expect_answer_refused(kNotARotation, [](auto& sample) { sample.T_map_body().rotation().x(2); });
  expect_answer_refused(kNotFinite, [](auto& sample) {
    sample.covariance().R()[3] = std::numeric_limits<float>::infinity();
  });
  expect_answer_refused(kOutOfRange,
                        [](auto& sample) { sample.T_map_odom().translation().z(-1e9); });
}

}  // namespace
}  // namespace fleetloc
