#include "shared/transport/monitoring/monitor_profiles.hpp"

#include "shared/transport/monitoring/embedded_profiles.hpp"
#include "shared/transport/qos_profiles.hpp"

namespace fleetloc {

void load_monitor_profiles(const std::optional<std::filesystem::path>& file, bool secure) {
  if (file) {
    load_qos_profiles(*file);
  } else if (secure) {
    load_embedded_qos_profiles(
        kMonitorProfiles, "monitor-secure.xml of this program", kMonitorSecureProfiles);
  } else {
    load_embedded_qos_profiles(kMonitorProfiles, "monitor.xml of this program");
  }
}

}  // namespace fleetloc
