#pragma once

#include <chrono>

#include "deploy/monitor/fleet_view.hpp"
#include "shared/core/arrival_time.hpp"

namespace fleetloc {

/// A fleet that is watched, wherever what is known of it comes from.
class WatchedFleet {
 public:
  WatchedFleet() = default;
  virtual ~WatchedFleet() = default;
  WatchedFleet(const WatchedFleet&) = delete;
  WatchedFleet& operator=(const WatchedFleet&) = delete;

  /// Takes what is new. To be called some times a second.
  virtual FleetView update(ArrivalTime now) = 0;

  /// After which its first view is complete.
  [[nodiscard]] virtual std::chrono::milliseconds settles_in() const = 0;

  /// Whether there is nothing more to come after this view.
  [[nodiscard]] virtual bool has_ended(const FleetView& view) const = 0;
};

}  // namespace fleetloc
