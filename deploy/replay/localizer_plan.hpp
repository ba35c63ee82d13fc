#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "shared/config/config_reader.hpp"

namespace fleetloc {

/// What becomes of the localizers of a replay.
struct LocalizerPlan {
  enum class Kind {
    kStart,
    kStop,  ///< as by SIGTERM: it drains and ends
    kKill,  ///< as by kill -9
  };
  struct Event {
    double at_s = 0.0;  ///< since the first IMU sample
    std::string localizer;
    Kind kind{};
  };
  std::vector<Event> events;  ///< in order of time
};

/// One localizer, from the start to the end.
LocalizerPlan one_localizer(std::string_view name);

/// `events: [{at_s, localizer, event: start, stop or kill}]`, in order of time.
/// @throws ConfigError that names the line
LocalizerPlan read_localizer_plan(ConfigReader config);

}  // namespace fleetloc
