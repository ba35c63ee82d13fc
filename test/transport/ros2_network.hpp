#pragma once

#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

#include "shared/transport/ros2/ros2_participant.hpp"
#include "shared/transport/ros2/ros2_profiles.hpp"
#include "test/test_folder.hpp"
#include "test/transport/test_domain.hpp"

namespace fleetloc {

/// The profiles of ROS 2 as they ship, but that participants of one process see each other.
inline std::string ros2_profiles_of_one_process() {
  std::ifstream file(FLEETLOC_SOURCE_DIR "/qos_profiles/ros2.xml");
  std::ostringstream text;
  text << file.rdbuf();
  const std::string filter = "<ignoreParticipantFlags>FILTER_SAME_PROCESS</ignoreParticipantFlags>";
  std::string profiles = text.str();
  const auto at = profiles.find(filter);
  if (at == std::string::npos) throw std::runtime_error("ros2.xml is no longer as expected");
  return profiles.erase(at, filter.size());
}

/// A domain of its own for the topics of ROS 2, and their profiles.
class Ros2Network {
 public:
  Ros2Network() {
    static const bool loaded = [] {
      const auto file = test_folder() / "ros2.xml";
      std::ofstream(file) << ros2_profiles_of_one_process();
      load_ros2_profiles(file);
      return true;
    }();
    static_cast<void>(loaded);
  }

  [[nodiscard]] std::uint32_t domain() const { return domain_.number(); }

 private:
  TestDomain domain_;
};

}  // namespace fleetloc
