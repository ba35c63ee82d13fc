#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "shared/model/correction.hpp"

namespace fleetloc {

inline constexpr std::size_t kMaxCorrectedPoses = 16;
inline constexpr std::size_t kMaxCorrectedLandmarks = 128;
inline constexpr double kMaxCorrectedMetres = 65.0;  ///< of a landmark, along each axis

/// Relative poses and landmarks, and the anchor's id, as a coded block; see idl/README.md.
///
/// What decode_corrections() returns differs by rounding: rotations by 1.5e-5 rad, translations by
/// 0.25 mm and landmarks by 1 mm per axis, information as CompactRoot says, with levels of 1/31.
///
/// Throws NotEncodable for items out of order or range, or too many of them.
std::vector<std::uint8_t> encode_corrections(const Correction& correction);

/// Nothing unless the bytes are a valid block. Robot, session, localizer and incarnation are the
/// caller's.
std::optional<Correction> decode_corrections(std::span<const std::uint8_t> bytes,
                                             KeyframeId anchor);

}  // namespace fleetloc
