#include "robot/cloud_client/localizer_events.hpp"

#include <cstdint>
#include <utility>

namespace fleetloc {
namespace {

constexpr std::size_t kMaxEvents = 100;  // further ones are dropped

}  // namespace

void LocalizerEvents::note(std::string event) {
  if (events_.size() < kMaxEvents) events_.push_back(std::move(event));
}

std::vector<std::string> LocalizerEvents::take() {
  return std::exchange(events_, {});
}

void LocalizerEvents::chosen(const LocalizerSelector& selector) {
  warning_.clear();
  other_map_.clear();
  note("localizer " + selector.name() + ", started as " +
       std::to_string(static_cast<std::uint32_t>(selector.incarnation())) + ": " +
       selector.reason());
}

void LocalizerEvents::left(const std::string& localizer, const LocalizerSelector& selector) {
  note("localizer " + localizer + " is left: " + selector.reason());
  warning_.clear();
  note_other_map(selector);
}

void LocalizerEvents::stays(const std::string& localizer) {
  note("localizer " + localizer + " goes on");
}

void LocalizerEvents::to_take_over(const LocalizerSelector::Successor& successor) {
  note("localizer " + successor.name + " is to take over: " + successor.reason);
}

void LocalizerEvents::unchanged(const LocalizerSelector& selector) {
  note_other_map(selector);
  note_warning(selector);
}

void LocalizerEvents::note_other_map(const LocalizerSelector& selector) {
  if (!selector.name().empty() || other_map_ == selector.other_map()) return;
  other_map_ = selector.other_map();
  if (other_map_.empty()) return;
  note("localizer " + other_map_ + " is refused: it has another map; dead reckoning");
}

void LocalizerEvents::note_warning(const LocalizerSelector& selector) {
  if (warning_ == selector.warning()) return;
  warning_ = selector.warning();
  note(warning_.empty() ? "localizer " + selector.name() + " is fine again"
                        : "localizer " + warning_ + ", and there is no other");
}

void LocalizerEvents::conflict(const std::string& localizer) {
  if (std::exchange(has_conflict_, true)) return;
  note("two localizers are named " + localizer + ": the one started first is not used");
}

void LocalizerEvents::foreign_writer(const std::string& localizer) {
  if (std::exchange(has_conflict_, true)) return;
  note("another program is named " + localizer + ": the one that came later is not used");
}

// After kSettledSeconds no answer to an earlier session of this robot can be in flight.
void LocalizerEvents::foreign_answer(Timestamp now) {
  constexpr double kSettledSeconds = 30.0;
  constexpr int kTooMany = 3;
  if (to_seconds(now - session_started_) < kSettledSeconds) return;
  if (++foreign_answers_ == kTooMany) {
    note("answers to another session arrive: another robot seems to have this id");
  }
}

}  // namespace fleetloc
