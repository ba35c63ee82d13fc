#include "deploy/sim/sensors/sensor_response.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace fleetloc {
namespace {

constexpr std::size_t kNormals = 4096;
constexpr std::size_t kPerDraw = 4;  // pixels that share the bits of one random number

/// Quantiles of the standard normal distribution, in the middle of equal shares.
std::array<float, kNormals> normal_quantiles() {
  std::array<float, kNormals> quantiles{};
  for (std::size_t i = 0; i < kNormals; ++i) {
    const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(kNormals);
    double low = -6.0;
    double high = 6.0;
    for (int step = 0; step < 40; ++step) {
      const double middle = 0.5 * (low + high);
      const double below = 0.5 * std::erfc(-middle / std::numbers::sqrt2);
      (below < share ? low : high) = middle;
    }
    quantiles.at(i) = static_cast<float>(low);
  }
  return quantiles;
}

}  // namespace

float Exposure::next(double time_s, float mean_radiance) {
  const float wanted = std::clamp(
      config_.target_gray / std::max(mean_radiance, 1e-6F), config_.min_gain, config_.max_gain);
  if (!gain_) {
    gain_ = wanted;
  } else {
    const auto passed = static_cast<float>(std::max(0.0, time_s - time_s_));
    const float share = config_.lag_s > 0.0F ? 1.0F - std::exp(-passed / config_.lag_s) : 1.0F;
    gain_ = *gain_ * std::pow(wanted / *gain_, share);
  }
  time_s_ = time_s;
  return *gain_;
}

void PixelResponse::respond(std::span<const float> radiance,
                            const Row& row,
                            std::span<std::uint8_t> gray) const {
  static const std::array<float, kNormals> quantiles = normal_quantiles();
  const float relative_gain = row.gain / noise_.reference_gain;
  const float read = noise_.read_gray * relative_gain;
  const float shot = noise_.shot_gray * relative_gain;
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < radiance.size(); ++i) {
    if (i % kPerDraw == 0) {
      const double drawn = random_.uniform(row.frame, (row.first_pixel + i) / kPerDraw);
      bits = static_cast<std::uint64_t>(drawn * 0x1.0p48);
    }
    const float normal = quantiles[bits % kNormals];
    bits /= kNormals;
    const float value = row.gain * radiance[i];
    const float sigma = std::sqrt(read * read + shot * value);
    gray[i] = static_cast<std::uint8_t>(std::clamp(value + sigma * normal + 0.5F, 0.0F, 255.0F));
  }
}

}  // namespace fleetloc
