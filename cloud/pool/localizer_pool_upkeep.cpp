// Robots that the pool does not serve: unknown ones, conflicts, departed ones.
#include <algorithm>
#include <utility>

#include "cloud/pool/localizer_pool.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/wire/localization_result_codec.hpp"

namespace fleetloc {
namespace {

constexpr std::size_t kMaxUnknownRobots = 256;
constexpr std::size_t kMaxConflicts = 256;
constexpr std::size_t kMaxEvents = 1000;  // nobody reads them
constexpr double kCleanupSeconds = 1.0;
constexpr double kForgetUnknownRobotSeconds = 10.0;
constexpr double kConflictOverSeconds = 30.0;  // without a sign of the other robot

}  // namespace

// Sent to the robot's own partition; the keyframe proves that the request answers its submap.
void LocalizerPool::request_session(const Submap& submap, Timestamp now) {
  if (submap.incarnation != incarnation_) {
    refuse(submap.robot, PoolRefusal::kOtherIncarnation);
  } else {
    refuse(submap.robot, SessionRefusal::kUnknown);
  }
  if (!robots_.contains(submap.robot) && robots_.size() >= config_.max_sessions) return;
  const auto known = unknown_robots_.find(submap.robot);
  if (known == unknown_robots_.end()
          ? unknown_robots_.size() >= kMaxUnknownRobots
          : to_seconds(now - known->second.requested) < config_.session_request_interval_s) {
    return;
  }
  LocalizationResult answer;
  answer.robot = submap.robot;
  answer.session = submap.session;
  answer.localizer = name_;
  answer.incarnation = incarnation_;
  answer.status = LocalizationStatus::kNeedFull;
  answer.keyframe = submap.keyframes.back().id;
  answer.revision = submap.keyframes.back().revision;
  answer.stamp = submap.keyframes.back().stamp;
  answer.map_hash = map_->info().hash;
  unknown_robots_[submap.robot] = {.requested = now, .unsent = std::move(answer)};
}

void LocalizerPool::add_session_requests(std::vector<Outgoing>& messages) {
  for (auto& [id, unknown_robot] : unknown_robots_) {
    if (!unknown_robot.unsent) continue;
    messages.push_back({id, {Topic::kLocalization, encode(*unknown_robot.unsent)}});
    unknown_robot.unsent.reset();
  }
}

void LocalizerPool::end(const RobotId& robot, const std::string& why) {
  const auto found = robots_.find(robot);
  if (found == robots_.end()) return;
  log_event(robot + ": session ended: " + why);
  if (departed_robots_.size() >= config_.max_sessions) {
    departed_robots_.erase(std::ranges::min_element(
        departed_robots_, {}, [](const auto& item) { return item.second.last_message; }));
  }
  departed_robots_[robot] = {.last_message = found->second.last_message,
                             .report = std::move(found->second.report)};
  robots_.erase(found);
  departed_.push_back(robot);
}

void LocalizerPool::remove_expired(Timestamp now) {
  if (last_cleanup_ && to_seconds(now - *last_cleanup_) < kCleanupSeconds) return;
  last_cleanup_ = now;
  std::vector<RobotId> idle;
  for (const auto& [id, robot] : robots_) {
    if (!robot.running && to_seconds(now - robot.last_message) > config_.idle_session_s) {
      idle.push_back(id);
    }
  }
  for (const RobotId& id : idle) end(id, "nothing was heard of the robot");
  std::erase_if(unknown_robots_, [&](const auto& item) {
    const bool is_over = to_seconds(now - item.second.requested) > kForgetUnknownRobotSeconds;
    if (is_over && !robots_.contains(item.first)) departed_.push_back(item.first);
    return is_over;
  });
  std::erase_if(conflicts_, [&](const auto& item) {
    return to_seconds(now - item.second) > kConflictOverSeconds;
  });
}

void LocalizerPool::refuse_superseded(const RobotId& robot, SessionRefusal refusal, Timestamp now) {
  refuse(robot, refusal);
  if (refusal != SessionRefusal::kConflict) return;
  const bool is_new = !conflicts_.contains(robot);
  if (is_new && conflicts_.size() >= kMaxConflicts) return;
  conflicts_[robot] = now;
  if (is_new) log_event(robot + ": two robots have this id: the one started first is refused");
}

void LocalizerPool::log_event(std::string event) {
  if (events_.size() < kMaxEvents) events_.push_back(std::move(event));
}

std::vector<RobotId> LocalizerPool::take_departed() {
  return std::exchange(departed_, {});
}

std::vector<std::string> LocalizerPool::take_events() {
  return std::exchange(events_, {});
}

std::map<RobotId, SessionReport> LocalizerPool::reports() const {
  std::map<RobotId, SessionReport> reports;
  for (const auto& [id, departed_robot] : departed_robots_) reports[id] = departed_robot.report;
  for (const auto& [id, robot] : robots_) reports[id] = robot.report;
  return reports;
}

LocalizerPool::Config read_localizer_pool_config(ConfigReader config) {
  ConfigReader pool = config.section("pool");
  const auto count = [&](const char* key, int max) {
    return static_cast<std::size_t>(pool.integer(key, 1, max));
  };
  return {.localizer = read_session_localizer_config(config.section("localizer")),
          .max_sessions = count("max_sessions", 100'000),
          .max_session_bytes = count("max_session_bytes", 1'000'000'000),
          .max_waiting_submaps = count("max_waiting_submaps", 10'000),
          .max_waiting_bytes = count("max_waiting_bytes", 1'000'000'000),
          .max_waiting_s = pool.positive("max_waiting_s"),
          .idle_session_s = pool.positive("idle_session_s"),
          .session_request_interval_s = pool.positive("session_request_interval_s"),
          .status_interval_s = pool.positive("status_interval_s"),
          .retransmission = read_retransmission_timer_config(pool.section("retransmission")),
          .sessions = read_session_register_config(pool.section("sessions"))};
}

}  // namespace fleetloc
