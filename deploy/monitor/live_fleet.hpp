#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "deploy/monitor/fleet_page.hpp"
#include "deploy/monitor/served_fleet.hpp"
#include "deploy/monitor/watched_fleet.hpp"
#include "shared/transport/monitoring/fleet_reader.hpp"

namespace fleetloc {

/// The fleet of a DDS domain, as its localizers tell it. Never ends.
class LiveFleet final : public WatchedFleet {
 public:
  /// load_monitor_profiles() first. Throws TransportError.
  /// @param page  shows it as well; may be null
  LiveFleet(std::uint32_t domain,
            std::unique_ptr<FleetPage> page,
            const std::optional<FleetKeys>& keys = std::nullopt);

  FleetView update(ArrivalTime now) override;
  [[nodiscard]] std::chrono::milliseconds settles_in() const override;
  [[nodiscard]] bool has_ended(const FleetView& /*view*/) const override { return false; }

 private:
  FleetReader reader_;
  ServedFleet fleet_;
  std::unique_ptr<FleetPage> page_;
};

}  // namespace fleetloc
