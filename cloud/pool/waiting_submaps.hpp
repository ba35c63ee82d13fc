#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <optional>
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

  /// Whether one more drops nothing.
  [[nodiscard]] bool has_room(std::size_t bytes, const Limits& limits) const {
    return waiting_.size() < limits.max_submaps &&
           (waiting_.empty() || bytes_ + bytes <= limits.max_bytes);
  }

  /// Nobody waits for these any more; but they stay, to be taken with what comes.
  /// @return how many there were
  std::size_t set_aside() {
    std::size_t count = 0;
    for (const Waiting& waiting : waiting_) count += waiting.received ? 1U : 0U;
    for (Waiting& waiting : waiting_) waiting.received.reset();
    return count;
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

  /// When the oldest that is not set aside came; nothing if there is none.
  [[nodiscard]] std::optional<Timestamp> oldest() const {
    const auto found = std::ranges::find_if(
        waiting_, [](const Waiting& waiting) { return waiting.received.has_value(); });
    return found == waiting_.end() ? std::nullopt : found->received;
  }

 private:
  struct Waiting {
    Submap submap;
    std::optional<Timestamp> received;
    std::size_t bytes{};
  };

  std::deque<Waiting> waiting_;
  std::size_t bytes_ = 0;
};

}  // namespace fleetloc
