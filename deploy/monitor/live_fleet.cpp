#include "deploy/monitor/live_fleet.hpp"

#include <utility>
#include <variant>

namespace fleetloc {

LiveFleet::LiveFleet(std::uint32_t domain,
                     std::unique_ptr<FleetPage> page,
                     const std::optional<FleetKeys>& keys)
    : reader_(domain, keys), page_(std::move(page)) {}

FleetView LiveFleet::update(ArrivalTime now) {
  for (const auto& news : reader_.take()) {
    std::visit([&](const auto& one) { fleet_.add(one, now); }, news);
  }
  fleet_.forget_silent(now);
  if (page_) page_->show(json_of(fleet_));
  return view_of(fleet_);
}

// Localizers are discovered, and then tell twice a second.
std::chrono::milliseconds LiveFleet::settles_in() const {
  return std::chrono::seconds(2);
}

}  // namespace fleetloc
