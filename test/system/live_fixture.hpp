#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "test/system/dds_fixture.hpp"

namespace fleetloc {

/// fleetloc-robot on topics of ROS 2, which have a DDS domain of their own.
class LiveFixture : public DdsFixture {
 protected:
  /// Writes sensors.yaml of the flight's recording.
  /// @param qos  of the topics: default (reliable) or sensor_data (best effort)
  /// @param more  further lines
  void describe_sensors(const std::string& qos = "default", const std::string& more = "") const {
    const auto topic = [&](const char* name) {
      return std::string("{name: ") + name + ", qos: " + qos + "}\n";
    };
    std::ofstream(sensors_) << "domain: " << ros_domain() << "\n"
                            << more << "topics:\n  left: " << topic("/camera/left/image_raw")
                            << "  right: " << topic("/camera/right/image_raw")
                            << "  imu: " << topic("/imu")
                            << "calibration:\n  euroc: {folder: " << flight_.folder.string()
                            << "}\n";
  }

  /// The command line of a robot with a start pose at the flight's first image.
  [[nodiscard]] Arguments live_robot(const std::string& id) const {
    Arguments arguments = live_robot_anywhere(id);
    arguments.insert(arguments.end(), {"--initial-pose", flight_.displaced_start_pose()});
    return arguments;
  }

  /// The same without a start pose.
  [[nodiscard]] Arguments live_robot_anywhere(const std::string& id) const {
    return {"--robot-id",
            id,
            "--sensors",
            sensors_.string(),
            "--qos",
            qos_,
            "--domain",
            network_.domain(),
            "--out",
            folder_of(id).string()};
  }

  [[nodiscard]] std::string ros_domain() const { return std::to_string(ros_domain_.number()); }

  const std::filesystem::path sensors_ = scratch_ / "sensors.yaml";

 private:
  const TestDomain ros_domain_;
};

}  // namespace fleetloc
