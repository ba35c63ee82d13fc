#include "cloud/pool/fair_scheduler.hpp"

#include <algorithm>
#include <chrono>

namespace fleetloc {
namespace {

constexpr Duration kMinJob = std::chrono::milliseconds(1);

}  // namespace

void FairScheduler::add(const RobotId& robot, Timestamp now) {
  Robot& known = robots_[robot];
  dequeue(robot, known);
  known.background.reset();
  const bool is_served = known.turn && !known.is_turn_in_background;
  if (!known.newest && !is_served) known.used = std::max(known.used, virtual_time_);
  known.newest = now;
  enqueue(robot, known);
}

void FairScheduler::add_background(const RobotId& robot) {
  Robot& known = robots_[robot];
  if (known.newest || known.background) return;
  known.background = ++backgrounds_;
  enqueue(robot, known);
}

void FairScheduler::drop_work(const RobotId& robot) {
  const auto known = robots_.find(robot);
  if (known == robots_.end()) return;
  dequeue(robot, known->second);
  known->second.newest.reset();
  known->second.background.reset();
}

void FairScheduler::erase(const RobotId& robot) {
  drop_work(robot);
  robots_.erase(robot);
}

std::vector<RobotId> FairScheduler::drop_stale(Timestamp now) {
  std::vector<RobotId> stale;
  while (!by_newest_work_.empty() &&
         to_seconds(now - by_newest_work_.begin()->first) > max_waiting_s_) {
    stale.push_back(by_newest_work_.begin()->second);
    drop_work(stale.back());
  }
  return stale;
}

std::optional<FairScheduler::Turn> FairScheduler::take() {
  const bool is_background = by_used_time_.empty();
  if (is_background && background_.empty()) return std::nullopt;
  const RobotId id = is_background ? background_.begin()->second : by_used_time_.begin()->second;
  Robot& robot = robots_.at(id);
  dequeue(id, robot);
  robot.newest.reset();
  robot.background.reset();
  robot.turn = ++turns_;
  robot.is_turn_in_background = is_background;
  if (!is_background) virtual_time_ = std::max(virtual_time_, robot.used);
  return Turn{.robot = id, .number = *robot.turn};
}

void FairScheduler::finish(const Turn& turn, Duration used) {
  const auto known = robots_.find(turn.robot);
  if (known == robots_.end() || known->second.turn != turn.number) return;
  Robot& robot = known->second;
  robot.turn.reset();
  if (!robot.is_turn_in_background) robot.used += std::max(kMinJob, used);
  enqueue(turn.robot, robot);
}

bool FairScheduler::is_running(const RobotId& robot) const {
  const auto known = robots_.find(robot);
  return known != robots_.end() && known->second.turn.has_value();
}

void FairScheduler::enqueue(const RobotId& id, const Robot& robot) {
  if (robot.turn) return;
  if (robot.background) background_.emplace(*robot.background, id);
  if (!robot.newest) return;
  by_used_time_.emplace(robot.used, id);
  by_newest_work_.emplace(*robot.newest, id);
}

void FairScheduler::dequeue(const RobotId& id, const Robot& robot) {
  if (robot.turn) return;
  if (robot.background) background_.erase(*robot.background);
  if (!robot.newest) return;
  by_used_time_.erase({robot.used, id});
  by_newest_work_.erase({*robot.newest, id});
}

}  // namespace fleetloc
