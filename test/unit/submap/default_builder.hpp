#pragma once

#include <cstddef>

#include "deploy/config/default_config.hpp"
#include "robot/submap/submap_builder.hpp"
#include "shared/config/config_reader.hpp"

namespace fleetloc {

inline constexpr std::size_t kWindow = 10;  // [keyframes]

inline SubmapBuilder::Config default_builder_config() {
  return read_submap_builder_config(
      ConfigReader::from_string(default_config("robot")).section("submap"));
}

}  // namespace fleetloc
