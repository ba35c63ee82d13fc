#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "shared/link/channel.hpp"
#include "shared/model/correction.hpp"
#include "shared/model/localization_result.hpp"
#include "shared/wire/malformed.hpp"

namespace fleetloc {

/// An answer with its corrections: one sample, one datagram.
struct Answer {
  LocalizationResult result;
  std::optional<Correction> correction;  ///< its anchor is the result's keyframe
};

/// Poses and covariance are left out, as identity and zero, unless the status is kLocalized; the
/// oldest stamp is the stamp then. Rotations are rounded by 2e-9 rad, the covariance by some
/// hundredths, times to milliseconds (the stamp is exact). Corrections that do not fit into
/// `max_payload_bytes` are left out: landmarks with the smallest information (trace) until few are
/// left, then the oldest relative poses, then the rest. Throws NotEncodable for what the receiver
/// would refuse.
Bytes encode(const Answer& answer, std::size_t max_payload_bytes);

/// Never throws.
Decoded<Answer> decode_answer(std::span<const std::uint8_t> bytes);

}  // namespace fleetloc
