#pragma once

#include <array>
#include <cstdint>

#include "shared/compact/compact_submap.hpp"
#include "shared/model/submap.hpp"

namespace fleetloc {

/// The newest keyframe's pose as the envelope states it.
struct NewestPose {
  static constexpr double kUnitsPerQuaternion = 16384.0;
  std::array<float, 3> p_odom{};           ///< [m]
  std::array<std::int16_t, 4> rotation{};  ///< w, x, y, z
};
NewestPose newest_pose(const Submap& submap);
StrictRotation rotation_of(const NewestPose& pose);  ///< expects one that is not all zero

/// What is coded of a submap: of each keyframe the observations of the subset, in steps of
/// 2^-step_bits px. The rest of a sample is in its envelope.
/// Throws NotEncodable for what cannot be coded.
CompactSubmap quantized(const Submap& submap,
                        const NewestPose& newest,
                        ObservationSubset subset,
                        std::uint32_t step_bits);

/// Of everything in a sample: a later sample's items replace its own.
constexpr Revision revision_of(SampleNumber number) {
  return Revision{static_cast<std::uint32_t>(number) + 1};
}

/// The submap that the integers stand for: the same bits on every machine. Items have the sample's
/// number as their revision, so a later sample's replace them. Keyframes that only edges need are
/// left out, and there are no landmarks. Robot, session, incarnation and number are the caller's.
/// @param stamp  of the newest keyframe
Submap submap_of(const CompactSubmap& coded,
                 const NewestPose& newest,
                 Timestamp stamp,
                 SampleNumber number);

}  // namespace fleetloc
