#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "deploy/sim/sensors/light.hpp"
#include "deploy/sim/world/season_scene.hpp"

namespace fleetloc {

/// Pixels that are traced together. The first packet is a lattice over the block with a node in
/// every row, column and diagonal of five pixels; the others are the remaining pixels, by rows.
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
  struct Shaded {
    std::array<ShadedPacket, kPackets> packets;
    std::array<std::uint32_t, kPackets> sunlit;                       ///< bits of their lanes
    std::array<RayPacket::Lanes<std::uint32_t>, kPackets> triangles;  ///< see HitPacket
  };

  /// Offsets of the pixels in the packets, lane by lane.
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

/// Traces and shades the rays, with fewer intersection tests where the lattice hits a few triangles
/// only: there an object that no ray of the lattice hits is lost, a speck or a line of less than
/// two pixels.
PixelBlock::Shaded shade_block(const SceneView& view,
                               const Light& light,
                               const PixelBlock::Packets& packets);

}  // namespace fleetloc
