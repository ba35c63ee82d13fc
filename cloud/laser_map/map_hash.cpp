#include "cloud/laser_map/map_hash.hpp"

#include <bit>
#include <cstdint>
#include <string_view>

namespace fleetloc {
namespace {

__extension__ using Uint128 = unsigned __int128;

constexpr Uint128 joined(std::uint64_t high, std::uint64_t low) {
  return Uint128{high} << 64U | low;
}

class Fnv1a128 {
 public:
  void add(float value) {
    constexpr Uint128 kPrime = joined(1U << 24U, 0x13b);
    const auto bits = std::bit_cast<std::uint32_t>(value);
    for (unsigned int shift = 0; shift < 32; shift += 8) {
      hash_ = (hash_ ^ static_cast<std::uint8_t>(bits >> shift)) * kPrime;
    }
  }

  [[nodiscard]] MapHash digest() const {
    MapHash hash{};
    for (std::size_t i = 0; i < hash.size(); ++i) {
      hash[i] = static_cast<std::uint8_t>(hash_ >> (120 - 8 * i));
    }
    return hash;
  }

 private:
  Uint128 hash_ = joined(0x6c62272e07bb0142U, 0x62b821756295c58dU);
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
