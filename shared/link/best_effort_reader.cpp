#include "shared/link/best_effort_reader.hpp"

#include <algorithm>

namespace fleetloc {

bool BestEffortReader::receive(std::uint64_t number, std::size_t fragment, std::size_t fragments) {
  if (number <= last_) return false;
  if (fragments > 1) {
    if (number < partial_) return false;
    if (number > partial_) held_.assign(fragments, false);
    partial_ = number;
    held_[fragment] = true;
    if (!std::ranges::all_of(held_, [](bool is_held) { return is_held; })) return false;
    partial_ = 0;
  }
  last_ = number;
  return true;
}

}  // namespace fleetloc
