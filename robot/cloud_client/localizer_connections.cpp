#include "robot/cloud_client/localizer_connections.hpp"

#include "shared/config/config_reader.hpp"

namespace fleetloc {

std::vector<std::string> LocalizerConnections::keep(const std::vector<std::string>& wanted,
                                                    Timestamp now) {
  std::vector<std::string> fresh;
  for (const std::string& localizer : wanted) {
    const auto [known, is_new] = connected_.insert_or_assign(localizer, now);
    if (!is_new) continue;
    channel_.prepare(known->first);
    fresh.push_back(known->first);
  }
  std::erase_if(connected_, [&](const auto& item) {
    const auto& [localizer, wanted_at] = item;
    const bool is_over = to_seconds(now - wanted_at) > config_.linger_s;
    if (is_over) channel_.release(localizer);
    return is_over;
  });
  return fresh;
}

LocalizerConnections::Config read_localizer_connections_config(ConfigReader config) {
  return {.standbys = static_cast<std::size_t>(config.integer("standbys", 0, 16)),
          .linger_s = config.positive("linger_s")};
}

}  // namespace fleetloc
