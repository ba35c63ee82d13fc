#pragma once

#include <cstdint>
#include <span>

#include "shared/compact/quantization.hpp"
#include "shared/core/ids.hpp"
#include "shared/core/time.hpp"
#include "shared/link/channel.hpp"
#include "shared/model/camera.hpp"
#include "shared/model/submap.hpp"
#include "shared/wire/malformed.hpp"

namespace fleetloc {

/// What the robot tells of the answers that it gets, beside each submap.
struct AnswerReceipt {
  std::uint32_t newest = 0;     ///< number of the newest answer that has arrived; 0: none
  double loss = 0.25;           ///< share of the answers that does not arrive, as far as is known
  std::optional<Duration> age;  ///< since the newest arrived; unknown when it is long ago
};

/// How exactly a submap is coded.
struct CompactPrecision {
  ObservationSubset subset;     ///< of each keyframe's observations
  std::uint32_t step_bits = 1;  ///< pixels are rounded to multiples of 2^-step_bits px, 0..7
};

/// A received sample of the compact encoding, before its block is decoded: that needs the
/// calibration, which the robot's session has.
struct SubmapSample {
  RobotId robot;
  SessionNumber session{};
  Incarnation incarnation{};
  SampleNumber number{};
  AnswerReceipt receipt;
  KeyframeId keyframe{};  ///< the newest one, and its stamp and pose
  Timestamp stamp;
  NewestPose pose;
  Bytes block;
};

SubmapHeader header_of(const SubmapSample& sample);

/// A submap as one sample of the compact encoding; landmarks are not sent.
/// Throws NotEncodable for what cannot be coded; the size is the caller's to check.
Bytes encode_compact(const Submap& submap,
                     const AnswerReceipt& receipt,
                     const CompactPrecision& precision,
                     const RectifiedStereo& stereo);

/// Never throws.
Decoded<SubmapSample> decode_submap_sample(std::span<const std::uint8_t> bytes);

/// The submap in it: the same bits on every machine, see submap_of(). Never throws.
/// @param stereo  of the session
Decoded<Submap> decode_submap(const SubmapSample& sample, const RectifiedStereo& stereo);

}  // namespace fleetloc
