#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "shared/model/served_robot.hpp"
#include "shared/model/session.hpp"
#include "shared/transport/participant.hpp"

namespace fleetloc {

/// A localizer's end of watching the fleet. It has a participant of its own, on ports that no robot
/// looks at: robots are not told of those who watch, and send and receive what they always do.
/// load_monitor_profiles() first. One thread at a time.
class FleetWriter {
 public:
  /// Throws TransportError.
  explicit FleetWriter(std::uint32_t domain, const std::optional<FleetKeys>& keys = std::nullopt);

  /// Whether anybody watches.
  [[nodiscard]] bool is_watched() const;

  void write(const LocalizerStatus& localizer, const std::vector<ServedRobot>& robots);

 private:
  Participant participant_;
  EntityPtr<eprosima::fastdds::dds::DataWriter> robots_;
  EntityPtr<eprosima::fastdds::dds::DataWriter> localizers_;
};

}  // namespace fleetloc
