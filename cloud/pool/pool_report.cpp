#include "cloud/pool/pool_report.hpp"

#include <algorithm>
#include <utility>

namespace fleetloc {
namespace {

constexpr std::size_t kMaxConflicts = 256;
constexpr std::size_t kMaxEvents = 1000;       // nobody reads them
constexpr double kConflictOverSeconds = 30.0;  // without a sign of the other robot

}  // namespace

void PoolReport::open(const RobotId& robot) {
  SessionReport& report = served_[robot];
  if (auto earlier = departed_.extract(robot)) report = std::move(earlier.mapped().report);
}

void PoolReport::close(const RobotId& robot, const std::string& why, Timestamp last_message) {
  log(robot + ": session ended: " + why);
  if (departed_.size() >= max_departed_) {
    departed_.erase(std::ranges::min_element(
        departed_, {}, [](const auto& item) { return item.second.last_message; }));
  }
  auto served = served_.extract(robot);
  departed_[robot] = {.last_message = last_message, .report = std::move(served.mapped())};
}

void PoolReport::refuse(const RobotId& robot, PoolRefusal refusal, Timestamp now) {
  if (const auto served = served_.find(robot); served != served_.end()) {
    served->second.refuse(refusal);
  } else {
    ++unattributed_[std::string(name(refusal))];
  }
  if (refusal == PoolRefusal::kConflictingSession) {
    note_conflict(robot, "two robots have this id: the one started first is refused", now);
  } else if (refusal == PoolRefusal::kForeignWriter) {
    note_conflict(robot, "another program speaks for it: who came later is refused", now);
  }
}

void PoolReport::note_conflict(const RobotId& robot, const std::string& what, Timestamp now) {
  const bool is_new = !conflicts_.contains(robot);
  if (is_new && conflicts_.size() >= kMaxConflicts) return;
  conflicts_[robot] = now;
  if (is_new) log(robot + ": " + what);
}

void PoolReport::log(std::string event) {
  if (events_.size() < kMaxEvents) events_.push_back(std::move(event));
}

void PoolReport::clean_up(Timestamp now) {
  std::erase_if(conflicts_, [&](const auto& item) {
    return to_seconds(now - item.second) > kConflictOverSeconds;
  });
}

std::vector<std::string> PoolReport::take_events() {
  return std::exchange(events_, {});
}

std::map<RobotId, SessionReport> PoolReport::reports() const {
  std::map<RobotId, SessionReport> reports = served_;
  for (const auto& [robot, departed] : departed_) reports.try_emplace(robot, departed.report);
  return reports;
}

}  // namespace fleetloc
