#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace fleetloc {

/// At most so many of them, in their order and at even distances.
template <typename Item>
std::vector<Item> evenly(const std::vector<Item>& items, int max_count) {
  const auto count = std::min(items.size(), static_cast<std::size_t>(max_count));
  std::vector<Item> result;
  result.reserve(count);
  for (std::size_t i = 0; i < count; ++i) result.push_back(items[i * items.size() / count]);
  return result;
}

}  // namespace fleetloc
