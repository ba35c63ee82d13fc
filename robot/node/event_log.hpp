#pragma once

#include "robot/cloud_client/cloud_client.hpp"
#include "robot/node/state_events.hpp"
#include "robot/runtime/robot_sink.hpp"
#include "shared/transport/dds_channel.hpp"

namespace fleetloc {

/// Logs what happens on the network and to the robot's state as it happens, and at the end what the
/// run has come to.
class EventLog final : public RobotSink {
 public:
  EventLog(const RobotId& robot, DdsChannel& channel, CloudClient& client)
      : robot_(robot), channel_(channel), client_(client) {}

  void add(const RobotOutput& output) override;
  void finish(const RunEnd& end) override;

 private:
  RobotId robot_;
  DdsChannel& channel_;
  CloudClient& client_;
  StateEvents state_;
  std::uint64_t frames_ = 0;
};

}  // namespace fleetloc
