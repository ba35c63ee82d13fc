#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "deploy/sim/sensors/light.hpp"
#include "deploy/sim/world/season_scene.hpp"

namespace fleetloc {

/// Pixels that are seen together. The first packet is a lattice over the block that meets every
/// row, column and diagonal of five pixels; the others are what it leaves out, by rows.
struct PixelBlock {
  static constexpr int kWidth = 10;
  static constexpr int kHeight = 8;
  static constexpr int kPixels = kWidth * kHeight;
  static constexpr int kPackets = kPixels / RayPacket::kSize;

  struct Offset {
    int u;
    int v;
  };
  using Packets = std::array<ViewPacket, kPackets>;
  struct Seen {
    std::array<ShadedPacket, kPackets> packets;
    std::array<std::uint32_t, kPackets> sunlit;                       ///< bits of their lanes
    std::array<RayPacket::Lanes<std::uint32_t>, kPackets> triangles;  ///< see HitPacket
  };

  /// Of the rays in the packets, lane by lane.
  static constexpr std::array<Offset, kPixels> lattice_first() {
    constexpr int kPerNode = 5;
    static_assert(kWidth % kPerNode == 0 && kPixels == kPerNode * RayPacket::kSize);
    std::array<Offset, kPixels> offsets{};
    std::size_t node = 0;
    std::size_t other = RayPacket::kSize;
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        const bool is_node = (u + 2 * v) % kPerNode == 2;
        offsets.at(is_node ? node++ : other++) = {.u = u, .v = v};
      }
    }
    return offsets;
  }
};

/// What each ray meets, with less tracing where the block shows a few triangles: there an object is
/// lost that no ray of the lattice meets, a speck or a line of less than two pixels.
PixelBlock::Seen shade_block(const SceneView& view,
                             const Light& light,
                             const PixelBlock::Packets& packets);

}  // namespace fleetloc
