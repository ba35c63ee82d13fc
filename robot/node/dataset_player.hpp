#pragma once

#include <chrono>
#include <stop_token>
#include <thread>
#include <variant>

#include "robot/dataset/dataset_reader.hpp"
#include "shared/concurrency/bounded_queue.hpp"

namespace fleetloc {

/// Reads a recording on a thread of its own, at `rate` times real time.
class DatasetPlayer {
 public:
  struct Played {
    DatasetReader::Item item;
    Duration decoding_cpu{};  ///< of an image pair
  };

  /// @param rate  0: as fast as the consumer reads
  DatasetPlayer(DatasetReader input, double rate);

  /// The next item; nothing at the end of the recording or when a stop is requested. Rethrows the
  /// reader's exception.
  std::optional<Played> next(const std::stop_token& stop);

  /// Stops the thread; next() returns nothing from then on.
  void stop();

  /// After stop().
  [[nodiscard]] const DatasetReader& input() const { return input_; }

 private:
  void play(const std::stop_token& stop);
  void wait_for(Timestamp stamp, const std::stop_token& stop);

  DatasetReader input_;  // used by the thread until the queue is closed
  double rate_;
  std::optional<Timestamp> first_stamp_;
  std::chrono::steady_clock::time_point started_;
  BoundedQueue<Played> played_;
  std::exception_ptr error_;  // set before the queue is closed
  std::jthread thread_;       // last: uses the others
};

}  // namespace fleetloc
