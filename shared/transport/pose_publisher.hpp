#pragma once

#include <cstdint>
#include <string>

#include "shared/link/channel.hpp"
#include "shared/transport/participant.hpp"

namespace fleetloc {

/// Publishes `fleetloc/pose` to programs on the robot's computer, in the partition of the robot's
/// id, on a participant of its own that is bound to loopback. At IMU rate; one thread at a time.
class PosePublisher {
 public:
  /// @param participant_profile  "local" in qos_profiles/
  PosePublisher(std::uint32_t domain,
                const std::string& robot,
                const std::string& participant_profile = "local");

  /// @param pose  a serialized PoseEstimate. False if the QoS limits refused it.
  bool publish(Bytes pose);

  int matched_readers();

 private:
  Participant participant_;
  EntityPtr<eprosima::fastdds::dds::DataWriter> writer_;
};

}  // namespace fleetloc
