#include "shared/transport/workarounds/route_cache.hpp"

namespace fleetloc {
namespace {

constexpr std::chrono::seconds kGood{1};
constexpr std::size_t kMaxAddresses = 4096;  // anybody may announce some

}  // namespace

bool RouteCache::has_route(std::uint32_t address, Clock::time_point now) {
  {
    const std::lock_guard lock(mutex_);
    const auto known = answers_.find(address);
    if (known != answers_.end() && now - known->second.at < kGood) return known->second.has_route;
  }
  const bool answer = lookup_(address);
  const std::lock_guard lock(mutex_);
  if (answers_.size() >= kMaxAddresses) answers_.clear();
  answers_[address] = {.has_route = answer, .at = now};
  return answer;
}

}  // namespace fleetloc
