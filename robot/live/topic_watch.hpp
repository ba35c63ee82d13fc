#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "shared/core/arrival_time.hpp"
#include "shared/core/time.hpp"

namespace fleetloc {

/// Notices that nothing comes on a topic, and that it is back. Each once, as a sentence.
class TopicWatch {
 public:
  /// @param silence  is said after this; four times that before the first message
  TopicWatch(std::string topic, Duration silence) : topic_(std::move(topic)), silence_(silence) {}

  /// A message, whatever it holds.
  std::optional<std::string> arrived(ArrivalTime now);
  /// Often enough: what is said late is late by the time between two calls.
  std::optional<std::string> check(ArrivalTime now);

  [[nodiscard]] const std::string& topic() const { return topic_; }
  [[nodiscard]] bool is_silent() const { return silent_; }

 private:
  std::string topic_;
  Duration silence_;
  std::optional<ArrivalTime> last_;  // message; before the first one, when watching began
  bool ever_ = false;
  bool silent_ = false;
};

/// Says what is wrong, but not again as long as it goes on.
class Complaints {
 public:
  /// @param kind  of a small set
  /// @return false if the same was wrong within the last 10 s
  bool is_new(std::string_view kind, ArrivalTime now);

 private:
  std::map<std::string, ArrivalTime, std::less<>> latest_;
};

/// "2.5 s"
std::string seconds_text(Duration duration);

}  // namespace fleetloc
