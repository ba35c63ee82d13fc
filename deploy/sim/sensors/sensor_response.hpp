#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "shared/core/counter_random.hpp"

namespace fleetloc {

/// Automatic exposure: the gain follows the brightness of the image with a lag.
class Exposure {
 public:
  struct Config {
    float target_gray;  ///< mean of the image
    float lag_s;        ///< time constant: 63 % of a change
    float min_gain;     ///< gray values per unit of radiance
    float max_gain;
  };
  explicit Exposure(const Config& config) : config_(config) {}

  /// Gain for an image of this mean radiance, taken at this time; times must not go back.
  float next(double time_s, float mean_radiance);

 private:
  Config config_;
  std::optional<float> gain_;
  double time_s_ = 0.0;
};

/// Turns radiance into gray values, with photon and read noise.
class PixelResponse {
 public:
  struct Noise {
    float read_gray;       ///< one sigma at the reference gain, in gray values; grows with the gain
    float shot_gray;       ///< variance per gray value at the reference gain; grows likewise
    float reference_gain;  ///< gray values per unit of radiance
  };
  struct Row {
    std::uint64_t frame;
    std::uint64_t first_pixel;  ///< index in the image, a multiple of 4
    float gain;
  };
  PixelResponse(const Noise& noise, const CounterRandom& random) : noise_(noise), random_(random) {}

  /// The noise depends on the random numbers given, the frame and the pixel alone.
  void respond(std::span<const float> radiance, const Row& row, std::span<std::uint8_t> gray) const;

 private:
  Noise noise_;
  CounterRandom random_;
};

}  // namespace fleetloc
