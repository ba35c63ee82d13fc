#pragma once

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <string>

#include "test/system/dds_fixture.hpp"

namespace fleetloc {

/// fleetloc-robot on topics of ROS 2, beside nodes whose DDS is Eclipse Cyclone.
class CycloneFixture : public DdsFixture {
 protected:
  /// The receive buffer that every socket gets where net.core.rmem_max is the kernel's default,
  /// whatever it is here [bytes].
  static constexpr const char* kDefaultBuffer = "212992";

  CycloneFixture() {
    const std::string uri =
        "file://" FLEETLOC_SOURCE_DIR
        "/qos_profiles/ros2-cyclonedds.xml,"
        "<CycloneDDS><Domain><Internal><SocketReceiveBufferSize min=\"default\" max=\"" +
        std::string(kDefaultBuffer) + "B\"/></Internal></Domain></CycloneDDS>";
    setenv("CYCLONEDDS_URI", uri.c_str(), 1);  // programs inherit it
    std::string profiles = content_of(FLEETLOC_SOURCE_DIR "/qos_profiles/ros2.xml");
    const std::string size = "<receiveBufferSize>4194304<";
    const auto at = profiles.find(size);
    if (at == std::string::npos) throw std::runtime_error("ros2.xml is no longer as expected");
    profiles.replace(at, size.size(), std::string("<receiveBufferSize>") + kDefaultBuffer + "<");
    std::ofstream(ros2_qos_) << profiles;
  }

  /// @param qos  of the topics in sensors.yaml: default (reliable) or sensor_data (best effort)
  void describe_sensors(const std::string& qos) const {
    std::ofstream(sensors_) << "domain: " << ros_domain() << "\nqos: " << ros2_qos_.string()
                            << "\ntopics:\n  left: {name: /camera/left/image_raw, qos: " << qos
                            << "}\n  right: {name: /camera/right/image_raw, qos: " << qos
                            << "}\n  imu: {name: /imu, qos: " << qos
                            << "}\ncalibration:\n  euroc: {folder: " << flight_.folder.string()
                            << "}\n";
  }

  [[nodiscard]] Arguments live_robot(const std::string& id) const {
    return {"--robot-id",
            id,
            "--sensors",
            sensors_.string(),
            "--qos",
            qos_,
            "--domain",
            network_.domain(),
            "--initial-pose",
            flight_.displaced_start_pose(),
            "--out",
            folder_of(id).string()};
  }

  [[nodiscard]] std::string ros_domain() const { return std::to_string(ros_domain_.number()); }

  const std::filesystem::path sensors_ = scratch_ / "sensors.yaml";

 private:
  const TestDomain ros_domain_;
  const std::filesystem::path ros2_qos_ = scratch_ / "ros2.xml";
};

/// Ends a program that has no end of its own.
inline Outcome ended(ChildProgram& program) {
  program.signal(SIGTERM);
  return program.wait();
}

}  // namespace fleetloc
