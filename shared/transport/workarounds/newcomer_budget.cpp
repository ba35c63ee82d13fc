#include "shared/transport/workarounds/newcomer_budget.hpp"

#include <algorithm>

namespace fleetloc {
namespace {

constexpr std::size_t kManyAddresses = 4096;  // each costs one of all, so they come slowly

}  // namespace

double NewcomerBudget::Left::now(Time now, double per_second, double at_most) const {
  const double elapsed_s = std::chrono::duration<double>(now - at).count();
  return std::min(at_most, count + per_second * elapsed_s);
}

bool NewcomerBudget::spend(std::uint32_t address, Time now) {
  const double of_all = all_.now(now, kOfAllPerSecond, kOfAll);
  const auto known = addresses_.find(address);
  const double of_address = known == addresses_.end()
                                ? kOfAddress
                                : known->second.now(now, kOfAddressPerSecond, kOfAddress);
  if (of_all < 1.0 || of_address < 1.0) return false;
  if (addresses_.size() >= kManyAddresses) forget_idle(now);
  all_ = {.count = of_all - 1.0, .at = now};
  addresses_[address] = {.count = of_address - 1.0, .at = now};
  return true;
}

void NewcomerBudget::forget_idle(Time now) {
  std::erase_if(addresses_, [&](const auto& one) {
    return one.second.now(now, kOfAddressPerSecond, kOfAddress) >= kOfAddress;
  });
}

}  // namespace fleetloc
