#pragma once

#include <chrono>

#include "shared/core/time.hpp"

namespace fleetloc {

/// Share of the workers' time in use, smoothed over a few seconds.
class WorkerLoad {
 public:
  WorkerLoad(int workers, Timestamp now) : workers_(workers), last_(now) {}

  /// @param busy  time that one worker has spent on a job
  void add(Duration busy) { busy_ += busy; }

  /// @return 0..1; a new value at most once a second
  double measure(Timestamp now) {
    const double elapsed_s = to_seconds(now - last_);
    if (elapsed_s < 1.0) return load_;
    load_ = 0.5 * load_ + 0.5 * to_seconds(busy_) / (elapsed_s * workers_);
    busy_ = {};
    last_ = now;
    return load_;
  }

 private:
  int workers_;
  Timestamp last_;
  Duration busy_{};
  double load_ = 0.0;
};

}  // namespace fleetloc
