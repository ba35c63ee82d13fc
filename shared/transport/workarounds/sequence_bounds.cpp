#include "shared/transport/workarounds/sequence_bounds.hpp"

#include <algorithm>

namespace fleetloc {

bool SequenceBounds::passes(std::uint32_t writer, std::int64_t number, Time now) {
  const auto known = writers_.find(writer);
  if (known == writers_.end()) {
    if (writers_.size() < kMaxWriters) writers_[writer] = {.highest = number, .seen = now};
    return true;
  }
  auto& [highest, seen] = known->second;
  if (number <= highest) return true;
  const double elapsed_s = std::chrono::duration<double>(now - seen).count();
  if (static_cast<double>(number - highest) > kLeap + kNumbersPerSecond * elapsed_s) return false;
  highest = number;
  seen = now;
  return true;
}

}  // namespace fleetloc
