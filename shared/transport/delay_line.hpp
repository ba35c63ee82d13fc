#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <stop_token>
#include <thread>

namespace fleetloc {

/// Runs actions at their times, one after the other, on a thread of its own.
class DelayLine {
 public:
  using Clock = std::chrono::steady_clock;

  DelayLine();
  ~DelayLine() { stop(); }
  DelayLine(const DelayLine&) = delete;
  DelayLine& operator=(const DelayLine&) = delete;

  void at(Clock::time_point time, std::function<void()> action);

  /// Drops pending actions. After it has returned no action runs, nor any that is added later.
  void stop();

 private:
  void run(const std::stop_token& stop);

  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::multimap<Clock::time_point, std::function<void()>> actions_;  // guarded by mutex_
  std::jthread thread_;
};

}  // namespace fleetloc
