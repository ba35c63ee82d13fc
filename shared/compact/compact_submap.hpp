#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "shared/compact/strict_pose.hpp"
#include "shared/compact/turn.hpp"

namespace fleetloc {

/// A submap in the integers that are coded; idl/README.md is the specification. Everything that the
/// cloud gets from a sample is computed from these numbers and the session's calibration.
struct CompactSubmap {
  static constexpr double kMetresPerUnit = 1e-3;             ///< of positions
  static constexpr std::int32_t kUnitsPerQuaternion = 4096;  ///< of a turn's components
  static constexpr std::int64_t kNanosecondsPerUnit = 1'000'000;
  static constexpr std::size_t kMaxKeyframes = 64;
  static constexpr std::size_t kMaxEdges = 128;
  static constexpr std::size_t kMaxObservations = 255;  ///< of a keyframe
  static constexpr int kUnknownTilt = 0;

  struct Observation {
    std::uint32_t landmark = 0;
    std::int32_t u = 0, v = 0;   ///< left image [pixel steps]
    std::int32_t disparity = 0;  ///< [pixel steps]; 0: not seen by the right camera
  };
  struct Keyframe {
    std::uint32_t id = 0;
    std::int32_t age = 0;                    ///< before the newest [ms]
    Turn turn;                               ///< from the next newer one; of the newest: none
    std::array<std::int32_t, 3> position{};  ///< from the newest, axes of odom [mm]
    bool has_observations = false;           ///< otherwise only edges need it
    std::int32_t tilt = kUnknownTilt;        ///< sigma of roll and pitch: SigmaCode
    std::vector<Observation> observations;   ///< strictly increasing by landmark
  };
  /// Measured relative pose, as its deviation from the keyframes' poses in quarters of its sigmas.
  struct Edge {
    std::uint32_t from = 0, to = 0;           ///< indices of keyframes, from < to
    std::array<std::int32_t, 3> sigma{};      ///< SigmaCode: rotation, horizontal, vertical
    std::array<std::int32_t, 6> deviation{};  ///< axes of odom: rotation, translation
  };

  StrictRotation newest_rotation{1.0, 0.0, 0.0, 0.0};  ///< of T_odom_body; from the envelope
  std::uint32_t stride = 1;  ///< observations are of landmarks with (id + keyframe id) % stride =
  std::uint32_t offset = 0;  ///< offset
  std::uint32_t step_bits = 1;      ///< a pixel step is 2^-step_bits px
  std::vector<Keyframe> keyframes;  ///< oldest first; not empty
  std::vector<Edge> edges;          ///< by `to`, then `from`
};

/// Rotation and position [m] of each keyframe, axes of odom, from the newest one's position.
std::vector<StrictPose> poses_of(const CompactSubmap& submap);

/// Standard deviations in steps of a quarter octave: code 1 is 16 (metres or radians), and each
/// further one a quarter octave less.
struct SigmaCode {
  static constexpr int kMax = 120;  ///< 1.8e-8
  static double sigma(int code);
  static int nearest(double sigma);  ///< 1..kMax
};

}  // namespace fleetloc
