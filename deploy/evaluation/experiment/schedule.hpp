#pragma once

#include <functional>
#include <stop_token>
#include <string>
#include <vector>

namespace fleetloc {

/// A piece of work that waits for child programs most of the time.
struct Task {
  std::string name;
  /// Returns a line for the user. Throws Interrupted if it ended for a stop. The slot counts from
  /// 0; no two tasks have the same one at the same time.
  std::function<std::string(const std::stop_token& stop, int slot)> run;
};

/// Called with the outcome of each task, one at a time.
using TaskEnded = std::function<void(const Task& task, const std::string& line)>;

/// Runs the tasks, in their order, `jobs` at a time. Returns once none runs any more: after all of
/// them, or after a stop. If one throws, the others are stopped and it is thrown again.
void run_tasks(const std::vector<Task>& tasks,
               int jobs,
               const std::stop_token& stop,
               const TaskEnded& ended);

}  // namespace fleetloc
