#pragma once

#include <cstddef>
#include <deque>
#include <utility>
#include <vector>

#include "shared/core/time.hpp"
#include "shared/model/submap.hpp"

namespace fleetloc {

/// What has arrived of one robot since its last localization. Bounded: the oldest are dropped.
class WaitingSubmaps {
 public:
  struct Limits {
    std::size_t max_submaps;
    std::size_t max_bytes;  ///< as received; a single submap may have more
  };

  /// @param bytes  size of the submap as it was received
  /// @return how many older ones were dropped
  std::size_t push(Submap submap, std::size_t bytes, Timestamp received, const Limits& limits) {
    bytes_ += bytes;
    waiting_.push_back({.submap = std::move(submap), .received = received, .bytes = bytes});
    std::size_t dropped = 0;
    while (waiting_.size() > limits.max_submaps ||
           (waiting_.size() > 1 && bytes_ > limits.max_bytes)) {
      bytes_ -= waiting_.front().bytes;
      waiting_.pop_front();
      ++dropped;
    }
    return dropped;
  }

  /// All of them, in the order in which they came.
  std::vector<Submap> take() {
    std::vector<Submap> submaps;
    for (Waiting& waiting : waiting_) submaps.push_back(std::move(waiting.submap));
    clear();
    return submaps;
  }

  /// @return how many there were
  std::size_t clear() {
    bytes_ = 0;
    return std::exchange(waiting_, {}).size();
  }

  /// When the oldest came. Expects that there is one.
  [[nodiscard]] Timestamp oldest() const { return waiting_.front().received; }

 private:
  struct Waiting {
    Submap submap;
    Timestamp received;
    std::size_t bytes{};
  };

  std::deque<Waiting> waiting_;
  std::size_t bytes_ = 0;
};

}  // namespace fleetloc
