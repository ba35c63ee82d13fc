#pragma once

#include <chrono>
#include <cstddef>

#include "deploy/monitor/fleet_view.hpp"

namespace fleetloc {

/// Standard output: on a terminal the table is drawn over the one before, elsewhere a line is added
/// now and then.
class Screen {
 public:
  Screen();

  [[nodiscard]] std::chrono::milliseconds interval() const;
  void show(const FleetView& view);

 private:
  bool is_terminal_;
  std::ptrdiff_t lines_ = 0;  // of the table before
};

}  // namespace fleetloc
