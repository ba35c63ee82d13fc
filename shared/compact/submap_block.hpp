#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "shared/compact/compact_submap.hpp"
#include "shared/model/camera.hpp"

namespace fleetloc {

/// The coded part of a sample; see idl/README.md.
std::vector<std::uint8_t> encode_block(const CompactSubmap& submap, const RectifiedStereo& stereo);

/// Nothing unless the bytes are what encode_block() writes for some valid submap.
/// @param newest_rotation  from the envelope
std::optional<CompactSubmap> decode_block(std::span<const std::uint8_t> bytes,
                                          const StrictRotation& newest_rotation,
                                          std::uint32_t newest_id,
                                          const RectifiedStereo& stereo);

}  // namespace fleetloc
