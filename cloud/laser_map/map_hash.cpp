#include "cloud/laser_map/map_hash.hpp"

#include <bit>
#include <cstdint>
#include <string_view>

namespace fleetloc {
namespace {

/// hash = (hash ^ byte) * (2^88 + 0x13b) modulo 2^128, on two halves.
class Fnv1a128 {
 public:
  void add_byte(std::uint8_t byte) {
    constexpr std::uint64_t kLowPrime = 0x13b;
    low_ ^= byte;
    const std::uint64_t low_half = (low_ & 0xffffffffU) * kLowPrime;
    const std::uint64_t high_half = (low_ >> 32U) * kLowPrime + (low_half >> 32U);
    high_ = high_ * kLowPrime + (high_half >> 32U) + (low_ << 24U);
    low_ = (high_half << 32U) | (low_half & 0xffffffffU);
  }

  void add(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    for (unsigned int shift = 0; shift < 32; shift += 8) {
      add_byte(static_cast<std::uint8_t>(bits >> shift));
    }
  }

  [[nodiscard]] MapHash digest() const {
    MapHash hash{};
    for (std::size_t i = 0; i < 8; ++i) {
      const auto shift = static_cast<unsigned int>(56 - 8 * i);
      hash[i] = static_cast<std::uint8_t>(high_ >> shift);
      hash[8 + i] = static_cast<std::uint8_t>(low_ >> shift);
    }
    return hash;
  }

 private:
  std::uint64_t high_ = 0x6c62272e07bb0142U;
  std::uint64_t low_ = 0x62b821756295c58dU;
};

}  // namespace

MapHash map_hash(std::span<const MapPoint> points) {
  Fnv1a128 hash;
  for (const MapPoint& point : points) {
    for (const float value : point.p_map) hash.add(value);
    for (const float value : point.normal) hash.add(value);
    hash.add(point.planarity);
  }
  return hash.digest();
}

std::string to_string(const MapHash& hash) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : hash) {
    text += kDigits[byte >> 4U];
    text += kDigits[byte & 0xfU];
  }
  return text;
}

}  // namespace fleetloc
