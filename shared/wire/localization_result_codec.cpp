#include "shared/wire/localization_result_codec.hpp"

#include <idl/localization.h>

#include "shared/wire/cdr.hpp"
#include "shared/wire/fields.hpp"

namespace fleetloc {
namespace {

// The enumerations list the same values in the same order.
static_assert(static_cast<int>(LocalizationStatus::kLocalized) == wire::LOCALIZED);
static_assert(static_cast<int>(LocalizationStatus::kNeedFull) == wire::NEED_FULL);
static_assert(static_cast<int>(LocalizationStatus::kNoStartPose) == wire::NO_START_POSE);
static_assert(static_cast<int>(LocalizationStatus::kTooFewKeyframes) == wire::TOO_FEW_KEYFRAMES);
static_assert(static_cast<int>(LocalizationStatus::kNoMapCoverage) == wire::NO_MAP_COVERAGE);
static_assert(static_cast<int>(LocalizationStatus::kTooFewMatches) == wire::TOO_FEW_MATCHES);
static_assert(static_cast<int>(LocalizationStatus::kNotConverged) == wire::NOT_CONVERGED);
static_assert(static_cast<int>(LocalizationStatus::kPoorFit) == wire::POOR_FIT);
static_assert(static_cast<int>(LocalizationStatus::kDegenerate) == wire::DEGENERATE);
static_assert(static_cast<int>(LocalizationStatus::kUnconfirmed) == wire::UNCONFIRMED);

constexpr std::int64_t kLongestHoldingTime_ns = 3'600'000'000'000;

Validity check_sample(const wire::LocalizationResult& sample) {
  if (sample.status() > wire::UNCONFIRMED) return unexpected(Malformed::kUnknownValue);
  for (const std::int64_t ns : {sample.stamp_ns(), sample.oldest_stamp_ns()}) {
    if (const Validity valid = check_stamp(ns); !valid) return valid;
  }
  if (sample.oldest_stamp_ns() > sample.stamp_ns()) return unexpected(Malformed::kUnorderedStamps);
  if (sample.holding_time_ns() < 0 || sample.holding_time_ns() > kLongestHoldingTime_ns) {
    return unexpected(Malformed::kOutOfRange);
  }
  if (const Validity valid = check(sample.T_map_body()); !valid) return valid;
  if (const Validity valid = check(sample.covariance()); !valid) return valid;
  return check(sample.T_map_odom());
}

}  // namespace

Bytes encode(const LocalizationResult& answer) {
  expect_encodable_id(answer.robot);
  expect_encodable_id(answer.localizer);
  wire::LocalizationResult sample;
  sample.robot(answer.robot);
  sample.localizer(answer.localizer);
  sample.session(static_cast<std::uint32_t>(answer.session));
  sample.incarnation(static_cast<std::uint32_t>(answer.incarnation));
  sample.acknowledged_base(static_cast<std::uint32_t>(answer.acknowledgements.base));
  sample.acknowledged_bitmap(answer.acknowledgements.bitmap);
  sample.status(static_cast<wire::LocalizationStatus>(answer.status));
  sample.keyframe(static_cast<std::uint32_t>(answer.keyframe));
  sample.revision(static_cast<std::uint32_t>(answer.revision));
  sample.stamp_ns(to_wire(answer.stamp));
  const bool localized = answer.status == LocalizationStatus::kLocalized;
  sample.oldest_stamp_ns(to_wire(localized ? answer.oldest_stamp : answer.stamp));
  sample.map_hash(answer.map_hash);
  sample.T_map_body(to_wire(localized ? answer.T_map_body : Pose{}));
  if (localized) sample.covariance(to_wire(answer.covariance));
  sample.T_map_odom(to_wire(localized ? answer.T_map_odom : Pose{}));
  sample.holding_time_ns(answer.holding_time.count());
  expect_encodable(check_sample(sample), "answer");
  return to_cdr(sample);
}

Decoded<LocalizationResult> decode_localization_result(std::span<const std::uint8_t> bytes) {
  const auto decoded = valid_from_cdr<wire::LocalizationResult>(bytes, 2, check_sample);
  if (!decoded) return unexpected(decoded.error());
  const auto& sample = *decoded;
  return LocalizationResult{.robot = sample.robot().to_string(),
                            .session = SessionNumber{sample.session()},
                            .localizer = sample.localizer().to_string(),
                            .incarnation = Incarnation{sample.incarnation()},
                            .acknowledgements = {.base = SampleNumber{sample.acknowledged_base()},
                                                 .bitmap = sample.acknowledged_bitmap()},
                            .status = static_cast<LocalizationStatus>(sample.status()),
                            .keyframe = KeyframeId{sample.keyframe()},
                            .revision = Revision{sample.revision()},
                            .stamp = stamp_from_wire(sample.stamp_ns()),
                            .oldest_stamp = stamp_from_wire(sample.oldest_stamp_ns()),
                            .map_hash = sample.map_hash(),
                            .T_map_body = from_wire(sample.T_map_body()),
                            .covariance = from_wire(sample.covariance()),
                            .T_map_odom = from_wire(sample.T_map_odom()),
                            .holding_time = Duration{sample.holding_time_ns()}};
}

}  // namespace fleetloc
