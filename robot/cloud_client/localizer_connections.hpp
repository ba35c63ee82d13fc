#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "shared/core/time.hpp"
#include "shared/link/channel.hpp"

namespace fleetloc {

class ConfigReader;

/// To which localizers the robot's end of the network is connected: to the chosen one, and to some
/// others, so that a failover does not wait for discovery. A localizer that is not wanted any more
/// stays connected for a while: the last words to it may be on their way, and it may be wanted
/// again.
class LocalizerConnections {
 public:
  struct Config {
    std::size_t standbys;  ///< connected beside the chosen one
    double linger_s;       ///< since a localizer was wanted last; then it is released
  };

  LocalizerConnections(Channel& channel, const Config& config)
      : channel_(channel), config_(config) {}

  [[nodiscard]] std::size_t standbys() const { return config_.standbys; }

  /// To be called regularly.
  /// @param wanted  the chosen one and its standbys
  /// @return those that were not connected before
  std::vector<std::string> keep(const std::vector<std::string>& wanted, Timestamp now);

 private:
  Channel& channel_;
  Config config_;
  std::map<std::string, Timestamp> connected_;  // when it was wanted last
};

LocalizerConnections::Config read_localizer_connections_config(ConfigReader config);

}  // namespace fleetloc
