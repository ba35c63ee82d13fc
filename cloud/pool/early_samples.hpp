#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include "shared/compact/submap_sample.hpp"
#include "shared/core/time.hpp"

namespace fleetloc {

/// Samples that came before the announcement of their session, without which they cannot be
/// decoded: on a bad network each datagram counts. Bounded in number and time.
class EarlySamples {
 public:
  struct Sample {
    SubmapSample sample;
    std::size_t bytes = 0;  ///< as received
  };

  /// Beyond the bounds it is dropped: the robot sends again what is missing.
  void keep(const SubmapSample& sample, std::size_t bytes, Timestamp now);

  /// Those of a robot's session, in the order in which they came; others of the robot are dropped.
  std::vector<Sample> take(const RobotId& robot, SessionNumber session);

  /// Drops what is too old to help. To be called from time to time.
  void clean_up(Timestamp now);

 private:
  struct Kept {
    Timestamp newest;
    std::vector<Sample> samples;
  };

  std::map<RobotId, Kept> robots_;
};

}  // namespace fleetloc
