#pragma once

#include "shared/core/time.hpp"

namespace fleetloc {

/// A time that goes on evenly while the sensors' clock is set. Estimators and the cloud see this
/// time, the consumers of poses see stamps; they are the same until the first step.
class ContinuousTime {
 public:
  [[nodiscard]] Timestamp time_of(Timestamp stamp) const { return stamp + offset_; }

  /// The stamp of a time, by the clock as it was then; only the latest step is remembered.
  [[nodiscard]] Timestamp stamp_of(Timestamp time) const {
    return time - (time < stepped_at_ ? offset_before_ : offset_);
  }

  /// From now on `stamp` is at `time`; a time before it has been before the step.
  void step(Timestamp stamp, Timestamp time) {
    offset_before_ = offset_;
    offset_ = time - stamp;
    stepped_at_ = time;
  }

 private:
  Duration offset_{};
  Duration offset_before_{};
  Timestamp stepped_at_ = Timestamp::min();
};

}  // namespace fleetloc
