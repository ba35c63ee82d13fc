#pragma once

#include <cstdint>
#include <span>

#include "shared/link/channel.hpp"
#include "shared/model/correction.hpp"
#include "shared/wire/malformed.hpp"

namespace fleetloc {

inline constexpr std::size_t kMaxCorrectionBytes = 1200;  ///< one datagram
inline constexpr std::size_t kMaxCorrectedPoses = 16;     ///< which fit in any case
inline constexpr double kMaxCorrectedMetres = 65.0;       ///< along each axis

/// Of landmarks that do not fit into kMaxCorrectionBytes, those with the smallest information
/// (trace) are left out.
///
/// What decode_correction returns differs by rounding: rotations by 2e-9 rad, translations by
/// 0.005 mm and landmarks by 1 mm per axis, information as CompactRoot says.
///
/// Throws NotEncodable for what the receiver would refuse: items out of order, none at all, more
/// than kMaxCorrectedPoses, edges beyond 20 km, landmarks beyond kMaxCorrectedMetres.
Bytes encode(const Correction& correction);

/// Never throws.
Decoded<Correction> decode_correction(std::span<const std::uint8_t> bytes);

}  // namespace fleetloc
