#pragma once

#include <deque>
#include <vector>

#include "shared/core/time.hpp"
#include "shared/model/inertial.hpp"

namespace fleetloc {

/// Recent IMU samples in order of time.
///
/// A time in which the body stood still can be left out: nothing happened in it, so that what came
/// before is joined to what comes after, with stamps that are later by its length.
class ImuBuffer {
 public:
  /// Refuses (returns false) a sample that is not possible, or not newer than the last one.
  bool add(const ImuSample& sample);

  /// Samples of [from, to], the ends interpolated linearly; empty unless the buffer covers both.
  /// The last one has stamp `to`, also where some of it was left out.
  [[nodiscard]] std::vector<ImuSample> between(Timestamp from, Timestamp to) const;

  /// The body stood still from `from` to `to`: leaves out the samples of [from, to). Covers both,
  /// and what was left out before ends before `from`, or begins there: then it goes on until `to`.
  void leave_out(Timestamp from, Timestamp to);

  /// How much of [from, to] is left out.
  [[nodiscard]] Duration left_out(Timestamp from, Timestamp to) const;

  void forget_before(Timestamp stamp);  ///< keeps one sample at or before it, for interpolation
  void keep(Duration time);             ///< the same, of the last `time` that is not left out

  [[nodiscard]] bool covers(Timestamp stamp) const;
  [[nodiscard]] bool begins_after(Timestamp stamp) const;  ///< so that it will never cover it

 private:
  struct Standstill {
    Timestamp from;
    Timestamp to;
  };
  [[nodiscard]] Timestamp joined(Timestamp stamp) const;
  void forget_joined_before(Timestamp stamp);

  std::deque<ImuSample> samples_;     // with joined stamps
  std::vector<Standstill> left_out_;  // oldest first; none within or before the oldest sample
};

}  // namespace fleetloc
