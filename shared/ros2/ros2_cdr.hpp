#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include "shared/cdr/cdr.hpp"
#include "shared/ros2/ros2_refusal.hpp"

namespace fleetloc {

/// A message of either byte order whose values are still to be checked.
template <typename T>
Ros2Decoded<T> from_ros2_cdr(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kEncapsulation = 4;
  const bool is_plain_cdr = bytes.size() >= kEncapsulation && bytes[0] == 0 && bytes[1] <= 1;
  std::optional<T> message = is_plain_cdr ? from_cdr<T>(bytes) : std::nullopt;
  if (!message) return unexpected(Ros2Refusal::kUndecodable);
  return *std::move(message);
}

}  // namespace fleetloc
