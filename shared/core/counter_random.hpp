#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include <Eigen/Core>

namespace fleetloc {

/// Counter-based random numbers: a function of seed, stream, index and item only, whatever the
/// order of the calls. SplitMix64 (Steele et al., 2014) as the hash.
class CounterRandom {
 public:
  CounterRandom(std::uint64_t seed, std::uint64_t stream) : key_(mix(mix(seed) ^ stream)) {}

  /// Uniform in (0, 1).
  [[nodiscard]] double uniform(std::uint64_t index, std::uint64_t item = 0) const {
    const std::uint64_t bits = mix(mix(key_ ^ index) ^ item);
    return (static_cast<double>(bits >> 11U) + 0.5) * 0x1.0p-53;
  }

  /// Standard normal, by Box and Muller. Uses the uniform items 2 item and 2 item + 1.
  [[nodiscard]] double normal(std::uint64_t index, std::uint64_t item = 0) const {
    const double radius = std::sqrt(-2.0 * std::log(uniform(index, 2 * item)));
    return radius * std::cos(2.0 * std::numbers::pi * uniform(index, 2 * item + 1));
  }

  [[nodiscard]] Eigen::Vector3d normal3(std::uint64_t index) const {
    return {normal(index, 0), normal(index, 1), normal(index, 2)};
  }

 private:
  static std::uint64_t mix(std::uint64_t x) {
    x += 0x9e3779b97f4a7c15U;
    x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9U;
    x = (x ^ (x >> 27U)) * 0x94d049bb133111ebU;
    return x ^ (x >> 31U);
  }

  std::uint64_t key_;
};

}  // namespace fleetloc
