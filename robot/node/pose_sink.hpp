#pragma once

#include <cstdint>

#include "robot/runtime/robot_sink.hpp"
#include "shared/transport/pose_publisher.hpp"

namespace fleetloc {

/// Publishes the poses at IMU rate to programs on the robot's computer.
class PoseSink final : public RobotSink {
 public:
  PoseSink(std::uint32_t domain, const RobotId& robot) : robot_(robot), publisher_(domain, robot) {}

  void add(const RobotOutput& output) override;
  /// "unpublished_poses": out of range of the wire type.
  [[nodiscard]] std::map<std::string, std::uint64_t> faults() const override;

 private:
  RobotId robot_;
  PosePublisher publisher_;
  std::uint64_t unpublished_ = 0;
};

}  // namespace fleetloc
