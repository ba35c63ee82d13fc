#pragma once

#include <chrono>
#include <stop_token>
#include <thread>
#include <variant>

#include "robot/dataset/dataset_reader.hpp"
#include "shared/concurrency/bounded_queue.hpp"

namespace fleetloc {

/// Plays a recording from a thread of its own, at the recording's pace times `rate`.
class DatasetPlayer {
 public:
  struct Played {
    DatasetReader::Item item;
    Duration decoding_cpu{};  ///< of an image pair
  };

  /// @param rate  0: as fast as the consumer takes
  DatasetPlayer(DatasetReader input, double rate);

  /// The next item; nothing at the end of the recording or when a stop is requested. Rethrows what
  /// ended the reading.
  std::optional<Played> next(const std::stop_token& stop);

  /// Ends the playing; next() gives nothing any more.
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
