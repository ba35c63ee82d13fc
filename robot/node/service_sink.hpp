#pragma once

#include "robot/runtime/robot_sink.hpp"
#include "shared/core/boot_time.hpp"
#include "shared/service/service_manager.hpp"

namespace fleetloc {

/// Tells the service manager that the robot's loop goes round, and how good its pose is.
class ServiceSink final : public RobotSink {
 public:
  explicit ServiceSink(ServiceManager& service) : service_(service) {}

  void add(const RobotOutput& output) override {
    const ArrivalTime now = boot_time();
    service_.alive(now);
    if (output.pose) service_.status(std::string(name(output.pose->quality)), now);
  }

 private:
  ServiceManager& service_;
};

}  // namespace fleetloc
