#include "shared/transport/ros2/ros2_profiles.hpp"

#include "shared/transport/qos_profiles.hpp"
#include "shared/transport/ros2/embedded_profiles.hpp"

namespace fleetloc {

void load_ros2_profiles(const std::optional<std::filesystem::path>& file) {
  if (file) {
    load_qos_profiles(*file);
  } else {
    load_embedded_qos_profiles(kRos2Profiles, "ros2.xml of this program");
  }
}

}  // namespace fleetloc
