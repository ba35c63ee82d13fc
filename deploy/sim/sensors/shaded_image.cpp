#include "deploy/sim/sensors/shaded_image.hpp"

#include <algorithm>

#include "shared/concurrency/parallel_rows.hpp"

namespace fleetloc {
namespace {

/// In each column, of a row and those above and below.
std::vector<int> sunlit_of_three(const ShadedImage& image, int v) {
  std::vector<int> sum(static_cast<std::size_t>(image.width_px));
  for (const int near : {v - 1, v, v + 1}) {
    const int row = std::clamp(near, 0, image.height_px - 1);
    const std::uint8_t* sunlit = &image.sunlit[image.index(0, row)];
    for (std::size_t u = 0; u < sum.size(); ++u) sum[u] += sunlit[u];
  }
  return sum;
}

/// About a pixel, on its surface.
float sunlit_share(const ShadedImage& image, int u, int v) {
  const std::uint32_t surface = image.keys[image.index(u, v)] >> 16U;
  int lit = 0;
  int count = 0;
  for (int y = std::max(v - 1, 0); y <= std::min(v + 1, image.height_px - 1); ++y) {
    for (int x = std::max(u - 1, 0); x <= std::min(u + 1, image.width_px - 1); ++x) {
      const std::size_t pixel = image.index(x, y);
      if (image.keys[pixel] >> 16U != surface) continue;
      lit += image.sunlit[pixel];
      ++count;
    }
  }
  return static_cast<float>(lit) / static_cast<float>(count);
}

}  // namespace

void add_sun(ShadedImage& image, int threads) {
  const auto width = static_cast<std::size_t>(image.width_px);
  for_each_row(image.height_px, threads, [&](int v) {
    const std::vector<int> lit = sunlit_of_three(image, v);
    for (std::size_t u = 0; u < width; ++u) {
      const int sum = lit[u > 0 ? u - 1 : u] + lit[u] + lit[std::min(u + 1, width - 1)];
      const int column = static_cast<int>(u);
      const std::size_t pixel = image.index(column, v);
      float share = sum == 9 ? 1.0F : 0.0F;
      if (sum != 0 && sum != 9) share = sunlit_share(image, column, v);
      image.radiance[pixel] += share * image.sun[pixel];
    }
  });
}

}  // namespace fleetloc
