#include "deploy/evaluation/experiment/schedule.hpp"

#include <algorithm>
#include <cstddef>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

#include "deploy/evaluation/experiment/programs.hpp"

namespace fleetloc {
namespace {

/// What the threads of one call share.
class Schedule {
 public:
  Schedule(const std::vector<Task>& tasks, const TaskEnded& ended) : tasks_(tasks), ended_(ended) {}

  void work(int slot) {
    while (const Task* task = next()) {
      try {
        const std::string line = task->run(stop_.get_token(), slot);
        const std::scoped_lock lock(mutex_);
        ended_(*task, line);
      } catch (const Interrupted&) {
        return;
      } catch (...) {
        fail(std::current_exception());
      }
    }
  }

  void stop() { stop_.request_stop(); }

  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  const Task* next() {
    const std::scoped_lock lock(mutex_);
    if (stop_.stop_requested() || next_ == tasks_.size()) return nullptr;
    return &tasks_[next_++];
  }

  void fail(const std::exception_ptr& error) {
    {
      const std::scoped_lock lock(mutex_);
      if (!error_) error_ = error;
    }
    stop();
  }

  const std::vector<Task>& tasks_;
  const TaskEnded& ended_;
  std::stop_source stop_;
  std::mutex mutex_;  // of what follows
  std::size_t next_ = 0;
  std::exception_ptr error_;
};

}  // namespace

void run_tasks(const std::vector<Task>& tasks,
               int jobs,
               const std::stop_token& stop,
               const TaskEnded& ended) {
  Schedule schedule(tasks, ended);
  const std::stop_callback on_stop(stop, [&schedule] { schedule.stop(); });
  {
    std::vector<std::jthread> threads;
    const int count = std::min(jobs, static_cast<int>(tasks.size()));
    threads.reserve(static_cast<std::size_t>(count));
    for (int slot = 0; slot < count; ++slot) {
      threads.emplace_back([&schedule, slot] { schedule.work(slot); });
    }
  }
  schedule.rethrow();
}

}  // namespace fleetloc
