#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include "robot/sensors/sensor_source.hpp"

namespace fleetloc {

/// What has been given out and not been taken, bounded: where the taker is too slow the oldest
/// frames make room for the newest one.
class MeasurementQueue {
 public:
  /// @param max_frames  at least 1
  /// @param max_imu  samples, at least 1
  MeasurementQueue(std::size_t max_frames, std::size_t max_imu)
      : max_frames_(max_frames), max_imu_(max_imu) {}

  void push(SensorMeasurement measurement);
  std::optional<SensorMeasurement> take();

  [[nodiscard]] std::size_t size() const { return queue_.size(); }
  [[nodiscard]] std::uint64_t dropped_frames() const { return dropped_frames_; }
  [[nodiscard]] std::uint64_t dropped_imu() const { return dropped_imu_; }

 private:
  template <typename Measurement>
  void make_room(std::size_t max, std::uint64_t& dropped);
  void merge_steps(ClockStep& step);

  std::size_t max_frames_;
  std::size_t max_imu_;
  std::deque<SensorMeasurement> queue_;
  std::uint64_t dropped_frames_ = 0;
  std::uint64_t dropped_imu_ = 0;
};

}  // namespace fleetloc
