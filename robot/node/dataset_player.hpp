#pragma once

#include <chrono>
#include <exception>
#include <memory>
#include <stop_token>
#include <thread>

#include "robot/sensors/sensor_source.hpp"
#include "shared/concurrency/bounded_queue.hpp"

namespace fleetloc {

/// Plays a recording on a thread of its own, at `rate` times real time.
class DatasetPlayer final : public SensorSource {
 public:
  /// @param rate  0: as fast as the consumer reads
  DatasetPlayer(std::unique_ptr<SensorSource> recording, double rate);

  /// Rethrows the recording's exception.
  std::optional<SensorMeasurement> next(const std::stop_token& stop) override;
  [[nodiscard]] std::optional<std::size_t> frame_count() const override { return frame_count_; }
  /// Stops the thread.
  std::map<std::string, std::uint64_t> close() override;

 private:
  void play(const std::stop_token& stop);
  void wait_for(Timestamp stamp, const std::stop_token& stop);

  std::unique_ptr<SensorSource> recording_;  // used by the thread until close()
  std::optional<std::size_t> frame_count_;
  double rate_;
  std::optional<Timestamp> first_stamp_;
  std::chrono::steady_clock::time_point started_;
  BoundedQueue<SensorMeasurement> played_;
  std::exception_ptr error_;  // set before the queue is closed
  std::jthread thread_;       // last: uses the others
};

}  // namespace fleetloc
