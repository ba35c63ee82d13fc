#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace fleetloc {

/// What the rays of an image see, pixel by pixel, by rows.
struct ShadedImage {
  ShadedImage(int width, int height)
      : width_px(width),
        height_px(height),
        radiance(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)),
        sun(radiance.size()),
        keys(radiance.size()),
        triangles(radiance.size()),
        sunlit(radiance.size()) {}

  [[nodiscard]] std::size_t index(int u, int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width_px) +
           static_cast<std::size_t>(u);
  }

  int width_px;
  int height_px;
  std::vector<float> radiance;           ///< until add_sun by the light of the sky alone
  std::vector<float> sun;                ///< see ShadedPacket
  std::vector<std::uint32_t> keys;       ///< see ShadedPacket
  std::vector<std::uint32_t> triangles;  ///< see HitPacket; kNoTriangle in the sky
  std::vector<std::uint8_t> sunlit;      ///< its own part of the sun is seen from there
};

/// Adds the sun's light to the radiance, with soft shadows: about a pixel, on its surface, three by
/// three pixels see each part of the sun equally often.
void add_sun(ShadedImage& image, int threads);

}  // namespace fleetloc
