#include "deploy/config/default_config.hpp"

#include <map>

#include "deploy/config/all_configs.hpp"
#include "deploy/config/each_config.hpp"

namespace fleetloc {

std::string_view default_config(std::string_view name) {
  static const std::map<std::string_view, std::string_view> configs = {
      {"robot", kRobotConfig},
      {"cloud", kCloudConfig},
      {"map", kMapConfig},
      {"replay", kReplayConfig},
      {"eval", kEvalConfig},
      {"sim", kSimConfig},
      {"everything", kDefaultConfig},
  };
  return configs.at(name);
}

}  // namespace fleetloc
