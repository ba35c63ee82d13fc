#include "shared/compact/submap_sample.hpp"

#include <algorithm>
#include <cmath>

#include <idl/compact_submap.h>

#include "shared/compact/submap_block.hpp"
#include "shared/wire/cdr.hpp"
#include "shared/wire/fields.hpp"

namespace fleetloc {
namespace {

constexpr std::size_t kMaxSubmapBlock = 1200;
constexpr std::uint16_t kLongAgo_ms = 65'535;
constexpr double kLossUnits = 255.0;
constexpr double kGravityNormTolerance = 1e-3;

Validity check_submap_sample(const wire::CompactSubmap& sample) {
  if (sample.block().size() > kMaxSubmapBlock) return unexpected(Malformed::kTooManyItems);
  if (const Validity valid = check_stamp(sample.stamp_ns()); !valid) return valid;
  for (const float value : sample.p_odom()) {
    if (const Validity valid = check(double{value}, -kMaxCoordinate, kMaxCoordinate); !valid) {
      return valid;
    }
  }
  double squares = 0.0;
  for (const std::int16_t value : sample.rotation()) {
    squares += std::pow(value / NewestPose::kUnitsPerQuaternion, 2);
  }
  if (std::abs(std::sqrt(squares) - 1.0) > kGravityNormTolerance) {
    return unexpected(Malformed::kNotARotation);
  }
  return {};
}

std::uint16_t age_ms(const AnswerReceipt& receipt) {
  const std::int64_t ms = receipt.age ? *receipt.age / std::chrono::milliseconds(1) : kLongAgo_ms;
  return static_cast<std::uint16_t>(std::clamp<std::int64_t>(ms, 0, kLongAgo_ms));
}

std::optional<Duration> age_of(std::uint16_t age_ms) {
  if (age_ms == kLongAgo_ms) return std::nullopt;
  return std::chrono::milliseconds(age_ms);
}

}  // namespace

SubmapHeader header_of(const SubmapSample& sample) {
  return {.robot = sample.robot,
          .session = sample.session,
          .incarnation = sample.incarnation,
          .number = sample.number,
          .keyframe = sample.keyframe,
          .revision = revision_of(sample.number),
          .stamp = sample.stamp};
}

Bytes encode_compact(const Submap& submap,
                     const AnswerReceipt& receipt,
                     const CompactPrecision& precision,
                     const RectifiedStereo& stereo) {
  expect_encodable_id(submap.robot);
  if (submap.keyframes.empty()) throw NotEncodable("the number of keyframes");
  const SubmapKeyframe& newest = submap.keyframes.back();
  const NewestPose pose = newest_pose(submap);
  wire::CompactSubmap sample;
  sample.robot(submap.robot);
  sample.session(static_cast<std::uint32_t>(submap.session));
  sample.incarnation(static_cast<std::uint32_t>(submap.incarnation));
  sample.number(static_cast<std::uint32_t>(submap.number));
  sample.answer(receipt.newest);
  sample.answer_loss(
      static_cast<std::uint8_t>(std::lround(kLossUnits * std::clamp(receipt.loss, 0.0, 1.0))));
  sample.answer_age_ms(age_ms(receipt));
  sample.keyframe(static_cast<std::uint32_t>(newest.id));
  sample.stamp_ns(to_wire(newest.stamp));
  sample.p_odom(pose.p_odom);
  sample.rotation(pose.rotation);
  sample.block(
      encode_block(quantized(submap, pose, precision.subset, precision.step_bits), stereo));
  const Validity valid = check_submap_sample(sample);
  if (!valid && valid.error() != Malformed::kTooManyItems) expect_encodable(valid, "submap");
  return to_cdr(sample);
}

Decoded<SubmapSample> decode_submap_sample(std::span<const std::uint8_t> bytes) {
  const auto decoded = valid_from_cdr<wire::CompactSubmap>(bytes, 1, check_submap_sample);
  if (!decoded) return unexpected(decoded.error());
  const auto& sample = *decoded;
  return SubmapSample{.robot = sample.robot().to_string(),
                      .session = SessionNumber{sample.session()},
                      .incarnation = Incarnation{sample.incarnation()},
                      .number = SampleNumber{sample.number()},
                      .receipt = {.newest = sample.answer(),
                                  .loss = sample.answer_loss() / kLossUnits,
                                  .age = age_of(sample.answer_age_ms())},
                      .keyframe = KeyframeId{sample.keyframe()},
                      .stamp = stamp_from_wire(sample.stamp_ns()),
                      .pose = {.p_odom = sample.p_odom(), .rotation = sample.rotation()},
                      .block = sample.block()};
}

Decoded<Submap> decode_submap(const SubmapSample& sample, const RectifiedStereo& stereo) {
  const auto block = decode_block(
      sample.block, rotation_of(sample.pose), static_cast<std::uint32_t>(sample.keyframe), stereo);
  if (!block) return unexpected(Malformed::kUndecodable);
  Submap submap = submap_of(*block, sample.pose, sample.stamp, sample.number);
  submap.robot = sample.robot;
  submap.session = sample.session;
  submap.incarnation = sample.incarnation;
  submap.number = sample.number;
  return submap;
}

}  // namespace fleetloc
