#pragma once

#include <chrono>

#include "shared/core/time.hpp"

namespace fleetloc {

/// Share of the workers' time in use, smoothed over a few seconds.
class WorkerLoad {
 public:
  WorkerLoad(int workers, Timestamp now) : workers_(workers), last_(now) {}

  void add(Duration busy) { busy_ += busy; }

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
