#include "robot/cloud_client/localizer_selector.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <ranges>
#include <utility>

#include "shared/config/config_reader.hpp"

namespace fleetloc {
namespace {

constexpr std::size_t kMaxLocalizers = 256;
constexpr double kEqualLoad = 0.1;  // differences below it do not matter
constexpr double kWorstLoss = 0.8;  // beyond, timeouts do not grow
constexpr int kMaxDoublings = 16;

// FNV-1a, then mixed: the same names give the same number on every machine.
std::uint64_t hash(std::string_view text, std::string_view more) {
  std::uint64_t value = 0xcbf29ce484222325U;
  const auto add = [&](unsigned char c) { value = (value ^ c) * 0x100000001b3U; };
  for (const char c : text) add(static_cast<unsigned char>(c));
  add('/');
  for (const char c : more) add(static_cast<unsigned char>(c));
  value ^= value >> 33U;
  value *= 0xff51afd7ed558ccdU;
  value ^= value >> 33U;
  value *= 0xc4ceb9fe1a85ec53U;
  return value ^ (value >> 33U);
}

double doubled(double seconds, int times, double longest) {
  return std::min(longest, std::ldexp(seconds, std::min(times, kMaxDoublings)));
}

}  // namespace

std::string_view name(StatusRefusal refusal) {
  switch (refusal) {
    case StatusRefusal::kOutdated:
      return "outdated_localizer";
    case StatusRefusal::kConflict:
      return "conflicting_localizer";
  }
  return "unknown";
}

LocalizerSelector::LocalizerSelector(std::string_view robot, const Config& config)
    : robot_(robot), config_(config) {}

expected<void, StatusRefusal> LocalizerSelector::update(const LocalizerStatus& status,
                                                        Timestamp now) {
  const auto known = known_.find(status.localizer);
  if (known == known_.end()) {
    if (known_.size() >= kMaxLocalizers) erase_stalest();
    known_[status.localizer] = {.status = status, .heard = now, .older_heard = {}};
    return {};
  }
  Known& localizer = known->second;
  if (status.incarnation < localizer.status.incarnation && is_alive(localizer, now)) {
    const bool alternate = localizer.older_heard && localizer.heard > *localizer.older_heard;
    localizer.older_heard = now;
    return unexpected(alternate ? StatusRefusal::kConflict : StatusRefusal::kOutdated);
  }
  if (status.incarnation != localizer.status.incarnation)
    localizer.excluded_until = Timestamp::min();
  localizer.status = status;
  localizer.heard = now;
  return {};
}

void LocalizerSelector::sent(Timestamp now) {
  if (!waiting_since_) waiting_since_ = now;
}

void LocalizerSelector::answered(Timestamp now) {
  has_answered_ = true;
  warning_.clear();
  waiting_since_.reset();
  last_activity_ = now;
  consecutive_timeouts_ = 0;
  known_.at(name_).consecutive_timeouts = 0;
}

LocalizerSelector::Change LocalizerSelector::decide(Timestamp now, const Link& link) {
  const auto other = best(now, false);
  if (name_.empty()) return choose_first(now);
  Known& current = known_.at(name_);
  if (!accepts_map(current.status.map_hash)) {
    return other == known_.end() ? leave("it has another map now")
                                 : choose(other, name_ + " has another map now", now);
  }
  if (current.status.incarnation != incarnation_) return follow_restart(current, now);
  if (!is_alive(current, now) && to_seconds(now - last_activity_) > config_.status_timeout_s) {
    const auto any = other != known_.end() ? other : best(now, true);
    return leave_unresponsive(current, any, name_ + " is gone", now);
  }
  if (is_silent(now, link))
    return leave_unresponsive(current, other, name_ + " does not answer", now);
  if (!current.status.accepting && !has_answered_) {
    return leave_unresponsive(current, other, name_ + " accepts no more robots", now);
  }
  if (other != known_.end() && is_overloaded_for_long(current, other->second, now)) {
    return choose(other, name_ + " is overloaded", now);
  }
  return Change::kNone;
}

LocalizerSelector::Change LocalizerSelector::choose_first(Timestamp now) {
  for (const bool even_excluded : {false, true}) {
    const auto candidate = best(now, even_excluded);
    if (candidate != known_.end()) return choose(candidate, "available", now);
  }
  return Change::kNone;
}

LocalizerSelector::Change LocalizerSelector::follow_restart(const Known& current, Timestamp now) {
  incarnation_ = current.status.incarnation;
  warning_.clear();
  reason_ = "it was restarted";
  has_answered_ = false;
  waiting_since_.reset();
  last_activity_ = now;
  return Change::kRestarted;
}

bool LocalizerSelector::is_alive(const Known& known, Timestamp now) const {
  return to_seconds(now - known.heard) <= config_.status_timeout_s;
}

bool LocalizerSelector::is_candidate(const Known& known, Timestamp now, bool even_excluded) const {
  return known.status.localizer != name_ && known.status.accepting && is_alive(known, now) &&
         accepts_map(known.status.map_hash) && (even_excluded || known.excluded_until <= now);
}

// The best one other than the chosen one.
LocalizerSelector::Candidate LocalizerSelector::best(Timestamp now, bool even_excluded) {
  double min_load = 1.0;
  other_map_.clear();
  for (const auto& [name, known] : known_) {
    if (is_candidate(known, now, even_excluded)) {
      min_load = std::min(min_load, known.status.load);
    } else if (known.status.accepting && is_alive(known, now) &&
               !accepts_map(known.status.map_hash)) {
      other_map_ = name;
    }
  }
  auto result = known_.end();
  std::uint64_t greatest = 0;
  for (auto it = known_.begin(); it != known_.end(); ++it) {
    if (!is_candidate(it->second, now, even_excluded)) continue;
    if (it->second.status.load > min_load + kEqualLoad) continue;
    const std::uint64_t preference = hash(robot_, it->first);
    if (result != known_.end() && preference <= greatest) continue;
    greatest = preference;
    result = it;
  }
  return result;
}

// As `best` would choose them; of those with more load the preferred one, too, so that a load that
// comes and goes does not change them.
std::vector<std::string> LocalizerSelector::standbys(std::size_t count, Timestamp now) const {
  std::vector<std::pair<std::uint64_t, std::string>> candidates;
  for (const auto& [name, known] : known_) {
    if (is_candidate(known, now, false)) candidates.emplace_back(hash(robot_, name), name);
  }
  std::ranges::sort(candidates, std::greater());
  std::vector<std::string> names;
  for (const auto& [preference, name] : candidates | std::views::take(count)) names.push_back(name);
  return names;
}

bool LocalizerSelector::is_silent(Timestamp now, const Link& link) const {
  if (!waiting_since_) return false;
  const double round_trip_s = link.round_trip ? to_seconds(*link.round_trip) : 0.0;
  const double once_s = config_.answer_timeout_s + config_.timeout_round_trips * round_trip_s;
  const double in_time_s = once_s / (1.0 - std::clamp(link.loss, 0.0, kWorstLoss));
  const double timeout_s =
      doubled(in_time_s, consecutive_timeouts_, std::max(in_time_s, config_.max_timeout_s));
  return to_seconds(now - *waiting_since_) > timeout_s;
}

// True once the overload has lasted for the patience of this robot.
bool LocalizerSelector::is_overloaded_for_long(const Known& current,
                                               const Known& other,
                                               Timestamp now) {
  const bool would_gain = current.status.load >= config_.overload &&
                          current.status.load - other.status.load >= config_.min_load_gain;
  if (!would_gain) {
    overloaded_since_.reset();
    return false;
  }
  if (!overloaded_since_) overloaded_since_ = now;
  const double share = static_cast<double>(hash(robot_, "patience") % 1000) / 1000.0;
  return to_seconds(now - *overloaded_since_) > config_.load_patience_s * (1.0 + share);
}

LocalizerSelector::Change LocalizerSelector::choose(Candidate candidate,
                                                    std::string reason,
                                                    Timestamp now) {
  reason_ = std::move(reason);
  name_ = candidate->first;
  incarnation_ = candidate->second.status.incarnation;
  has_answered_ = false;
  waiting_since_.reset();
  last_activity_ = now;
  overloaded_since_.reset();
  return Change::kChosen;
}

// Without another localizer the robot stays, with a warning.
LocalizerSelector::Change LocalizerSelector::leave_unresponsive(Known& current,
                                                                Candidate other,
                                                                std::string reason,
                                                                Timestamp now) {
  warning_ = other == known_.end() ? reason : "";
  if (other == known_.end()) return Change::kNone;
  current.excluded_until =
      now + from_seconds(doubled(
                config_.exclusion_s, current.consecutive_timeouts, config_.max_exclusion_s));
  ++current.consecutive_timeouts;
  ++consecutive_timeouts_;
  return choose(other, std::move(reason), now);
}

LocalizerSelector::Change LocalizerSelector::leave(std::string reason) {
  reason_ = std::move(reason);
  name_.clear();
  warning_.clear();
  waiting_since_.reset();
  return Change::kLeft;
}

void LocalizerSelector::erase_stalest() {
  known_.erase(std::ranges::min_element(known_, {}, [&](const auto& item) {
    return item.first == name_ ? Timestamp::max() : item.second.heard;
  }));
}

LocalizerSelector::Config read_localizer_selector_config(ConfigReader config) {
  return {.answer_timeout_s = config.positive("answer_timeout_s"),
          .timeout_round_trips = config.positive("timeout_round_trips"),
          .max_timeout_s = config.positive("max_timeout_s"),
          .status_timeout_s = config.positive("status_timeout_s"),
          .exclusion_s = config.positive("exclusion_s"),
          .max_exclusion_s = config.positive("max_exclusion_s"),
          .overload = config.positive("overload"),
          .min_load_gain = config.positive("min_load_gain"),
          .load_patience_s = config.positive("load_patience_s")};
}

}  // namespace fleetloc
