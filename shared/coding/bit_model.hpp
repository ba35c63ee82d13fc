#pragma once

#include <cstdint>

namespace fleetloc {

/// The probability that a bit is set, learnt from the bits of its kind so far: the mean of a quick
/// and a slow average, so that few bits tell something and many tell more.
class BitModel {
 public:
  static constexpr int kProbabilityBits = 15;

  /// @param share  that the bit is set, in 1/256; 1..255
  constexpr explicit BitModel(std::uint8_t share = 128)
      : quick_(static_cast<std::uint16_t>(share << 8)), slow_(quick_) {}

  /// In units of 2^-kProbabilityBits, never 0 nor 1.
  [[nodiscard]] constexpr std::uint32_t probability_of_zero() const {
    const std::uint32_t one = (std::uint32_t{quick_} + slow_) >> 2;
    return kOne - (one < kLeast ? kLeast : one > kOne - kLeast ? kOne - kLeast : one);
  }

  constexpr void learn(bool bit) {
    constexpr std::uint32_t kFull = 65535;
    const std::uint32_t target = bit ? kFull : 0;
    quick_ = moved(quick_, target, 4);
    slow_ = moved(slow_, target, 7);
  }

 private:
  static constexpr std::uint32_t kOne = 1U << kProbabilityBits;
  static constexpr std::uint32_t kLeast = 64;

  static constexpr std::uint16_t moved(std::uint32_t from, std::uint32_t to, int shift) {
    return static_cast<std::uint16_t>(to > from ? from + ((to - from) >> shift)
                                                : from - ((from - to) >> shift));
  }

  std::uint16_t quick_, slow_;  // [2^-16]
};

}  // namespace fleetloc
