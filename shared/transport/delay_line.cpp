#include "shared/transport/delay_line.hpp"

#include <utility>

namespace fleetloc {

DelayLine::DelayLine() : thread_([this](const std::stop_token& stop) { run(stop); }) {}

void DelayLine::at(Clock::time_point time, std::function<void()> action) {
  const std::lock_guard lock(mutex_);
  actions_.emplace(time, std::move(action));  // behind those of the same time
  changed_.notify_all();
}

void DelayLine::stop() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
  const std::lock_guard lock(mutex_);
  actions_.clear();
}

void DelayLine::run(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    if (actions_.empty()) {
      changed_.wait(lock, stop, [this] { return !actions_.empty(); });
      continue;
    }
    const Clock::time_point next = actions_.begin()->first;
    if (Clock::now() < next) {
      const auto earlier = [&] { return !actions_.empty() && actions_.begin()->first < next; };
      changed_.wait_until(lock, stop, next, earlier);
      continue;
    }
    const auto due = actions_.extract(actions_.begin());
    lock.unlock();
    due.mapped()();
    lock.lock();
  }
}

}  // namespace fleetloc
