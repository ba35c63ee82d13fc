#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace fleetloc {

/// Shading of an image, pixel by pixel, row by row.
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
  std::vector<float> radiance;           ///< by ambient light alone until add_sun()
  std::vector<float> sun;                ///< see ShadedPacket
  std::vector<std::uint32_t> keys;       ///< see ShadedPacket
  std::vector<std::uint32_t> triangles;  ///< see HitPacket; kNoTriangle in the sky
  std::vector<std::uint8_t> sunlit;      ///< its own sample of the sun is visible from there
};

/// Adds sunlight to the radiance, with soft shadows: the mean over three by three pixels of the
/// same surface, which have each sample of the sun equally often.
void add_sun(ShadedImage& image, int threads);

}  // namespace fleetloc
