#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "shared/core/ids.hpp"
#include "shared/core/time.hpp"

namespace fleetloc {

/// Whose work comes next: worker time is shared out evenly among the robots that wait, whatever
/// their jobs take, and a robot has one job at a time. Start-time fair queueing (Goyal, Vin, Cheng,
/// SIGCOMM 1996) with equal weights: served is who has used the least time. The virtual time is
/// that of the robot that was served last; who begins to wait starts from it, so that an absence
/// neither saves time up nor has to be made up for.
///
/// Work in the background has the time that nobody else wants, in turns among those that have some;
/// it is held against no robot.
///
/// Every operation takes O(log n) for n robots.
class FairScheduler {
 public:
  /// A robot whose turn it is, until finish().
  struct Turn {
    RobotId robot;
    std::uint64_t number = 0;
  };

  /// @param max_waiting_s  since its newest work; then a robot that waits has stopped sending
  explicit FairScheduler(double max_waiting_s) : max_waiting_s_(max_waiting_s) {}

  /// New work of a robot waits, known or not.
  void add(const RobotId& robot, Timestamp now);

  /// Goes on with what the robot's last turn has left, when no other work waits; done with the work
  /// of the robot that may wait already.
  void add_background(const RobotId& robot);

  /// All of the robot's work that waits is gone. What it has used still counts.
  void drop_work(const RobotId& robot);

  /// The robot is forgotten; the turn that it may have ends without effect.
  void erase(const RobotId& robot);

  /// Drops the work of robots that have stopped sending. @return whose
  std::vector<RobotId> drop_stale(Timestamp now);

  /// All waiting work of the robot that has used the least time; of several, the first by id. If
  /// none waits, the background of the robot that has waited longest with it.
  std::optional<Turn> take();

  /// @param used  worker time; at least a millisecond counts, so that turns are taken in any case
  void finish(const Turn& turn, Duration used);

  [[nodiscard]] bool is_running(const RobotId& robot) const;

 private:
  struct Robot {
    Duration used{};                          // virtual time
    std::optional<Timestamp> newest;          // of the work that waits; nothing: none does
    std::optional<std::uint64_t> background;  // that waits: numbered in the order of waiting
    std::optional<std::uint64_t> turn;        // its job that runs
    bool is_turn_in_background = false;
  };

  void enqueue(const RobotId& id, const Robot& robot);
  void dequeue(const RobotId& id, const Robot& robot);

  double max_waiting_s_;
  std::map<RobotId, Robot> robots_;
  // Robots that wait and have no job running, by either order.
  std::set<std::pair<Duration, RobotId>> by_used_time_;
  std::set<std::pair<Timestamp, RobotId>> by_newest_work_;
  std::map<std::uint64_t, RobotId> background_;
  Duration virtual_time_{};
  std::uint64_t turns_ = 0;
  std::uint64_t backgrounds_ = 0;
};

}  // namespace fleetloc
