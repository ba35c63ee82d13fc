#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shared/transport/topic_observer.hpp"

namespace fleetloc {

/// What was heard of a topic.
struct HeardTraffic {
  std::size_t samples = 0;
  std::size_t bytes = 0;  ///< payload
};

/// A line for each topic, under headings; each with a newline.
/// @param heard      by topic
/// @param listened_s for how long; nothing: rates are not known
std::string topic_table(const std::vector<ObservedTopic>& topics,
                        const std::map<std::string, HeardTraffic>& heard,
                        std::optional<double> listened_s);

/// Whether a topic is meant by what a user wrote: its name, or its last parts ("submap",
/// "robot_1/localization"); empty means all.
bool is_meant(std::string_view wanted, std::string_view topic);

}  // namespace fleetloc
