#pragma once

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <string>

#include "test/system/live_fixture.hpp"

namespace fleetloc {

/// fleetloc-robot on topics of ROS 2, beside nodes whose DDS is Eclipse Cyclone.
class CycloneFixture : public LiveFixture {
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

  /// @param qos  see LiveFixture
  void describe_sensors(const std::string& qos) const {
    LiveFixture::describe_sensors(qos, "qos: " + ros2_qos_.string() + "\n");
  }

 private:
  const std::filesystem::path ros2_qos_ = scratch_ / "ros2.xml";
};

/// Ends a program that has no end of its own.
inline Outcome ended(ChildProgram& program) {
  program.signal(SIGTERM);
  return program.wait();
}

}  // namespace fleetloc
