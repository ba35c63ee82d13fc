#include "robot/live/topic_watch.hpp"

#include <iomanip>
#include <sstream>

namespace fleetloc {

std::string seconds_text(Duration duration) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(1) << to_seconds(duration) << " s";
  return text.str();
}

std::optional<std::string> TopicWatch::arrived(ArrivalTime now) {
  const Duration since = last_ ? now - *last_ : Duration{};
  const bool was_silent = silent_;
  const bool first = !ever_;
  last_ = now;
  ever_ = true;
  silent_ = false;
  if (!was_silent) return std::nullopt;
  return topic_ + (first ? ": messages come after " : ": messages come again after ") +
         seconds_text(since);
}

std::optional<std::string> TopicWatch::check(ArrivalTime now) {
  constexpr int kPatience = 4;  // drivers start when they start
  if (!last_) last_ = now;
  const Duration limit = ever_ ? silence_ : kPatience * silence_;
  if (silent_ || now - *last_ < limit) return std::nullopt;
  silent_ = true;
  return topic_ + (ever_ ? ": no message for " : ": no message has come for ") +
         seconds_text(now - *last_);
}

bool Complaints::is_new(std::string_view kind, ArrivalTime now) {
  constexpr Duration kRepeatedAfter = std::chrono::seconds(10);
  const auto found = latest_.find(kind);
  if (found == latest_.end()) {
    latest_.emplace(kind, now);
    return true;
  }
  const bool is_new = now - found->second > kRepeatedAfter;
  found->second = now;
  return is_new;
}

}  // namespace fleetloc
