#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "robot/live/sensors_config.hpp"

namespace fleetloc {

inline constexpr int kWidth = 64;  ///< of the images [px]
inline constexpr int kHeight = 48;

/// Topics that are reliable.
inline SensorsConfig sensors(std::uint32_t domain) {
  SensorsConfig config;
  config.domain = static_cast<int>(domain);
  config.left.topic = {.name = "/left", .qos = TopicQos::kDefault};
  config.right.topic = {.name = "/right", .qos = TopicQos::kDefault};
  config.imu = {.name = "/imu", .qos = TopicQos::kDefault};
  return config;
}

/// What has been said, by any thread.
class Log {
 public:
  [[nodiscard]] std::function<void(const std::string&)> say() {
    return [this](const std::string& event) {
      const std::lock_guard lock(mutex_);
      events_.push_back(event);
    };
  }
  [[nodiscard]] std::vector<std::string> events() const {
    const std::lock_guard lock(mutex_);
    return events_;
  }
  [[nodiscard]] bool has(const std::string& part) const {
    return std::ranges::any_of(
        events(), [&](const std::string& event) { return event.find(part) != std::string::npos; });
  }

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> events_;
};

}  // namespace fleetloc
