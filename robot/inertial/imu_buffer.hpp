#pragma once

#include <deque>
#include <vector>

#include "shared/core/time.hpp"
#include "shared/model/inertial.hpp"

namespace fleetloc {

/// Recent IMU samples in order of time.
class ImuBuffer {
 public:
  /// Refuses (returns false) a sample that is not finite, or not newer than the last one.
  bool add(const ImuSample& sample);

  /// Samples of [from, to], the ends interpolated linearly; empty unless the buffer covers both.
  [[nodiscard]] std::vector<ImuSample> between(Timestamp from, Timestamp to) const;

  void forget_before(Timestamp stamp);  ///< keeps one sample at or before it, for interpolation

  [[nodiscard]] bool covers(Timestamp stamp) const;
  [[nodiscard]] bool begins_after(Timestamp stamp) const;  ///< so that it will never cover it

 private:
  std::deque<ImuSample> samples_;
};

}  // namespace fleetloc
