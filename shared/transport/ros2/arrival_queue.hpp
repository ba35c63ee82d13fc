#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <stop_token>
#include <vector>

#include "shared/core/arrival_time.hpp"
#include "shared/link/channel.hpp"

namespace fleetloc {

/// A sample of a ROS 2 topic, as it came.
struct Ros2Sample {
  std::size_t topic = 0;  ///< number of its subscription
  Bytes payload;          ///< CDR with its encapsulation; nothing of it is checked
  ArrivalTime arrival;
};

/// Hands samples of some topics from one thread to another, in the order of their arrival. Each
/// topic has a capacity of its own, so that none of them takes the room of another: where it is
/// used up, the oldest sample of that topic is dropped and counted.
class ArrivalQueue {
 public:
  /// @param capacities  of each topic, samples, at least 1
  explicit ArrivalQueue(const std::vector<std::size_t>& capacities);

  void push(Ros2Sample sample);

  /// Waits for a sample, at most `max_wait`. Nothing when a stop is requested.
  std::optional<Ros2Sample> pop(const std::stop_token& stop, std::chrono::milliseconds max_wait);

  /// Samples of a topic that had to make room.
  [[nodiscard]] std::uint64_t dropped(std::size_t topic) const;

 private:
  struct Numbered {
    std::uint64_t number;
    Ros2Sample sample;
  };
  struct Topic {
    std::size_t capacity;
    std::deque<Numbered> waiting;
    std::uint64_t dropped = 0;
  };

  [[nodiscard]] Topic* first_arrived();

  mutable std::mutex mutex_;
  std::condition_variable_any arrived_;
  std::vector<Topic> topics_;   // guarded by mutex_
  std::uint64_t arrivals_ = 0;  // guarded by mutex_
};

}  // namespace fleetloc
