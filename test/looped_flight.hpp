#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robot/sensors/sensor_source.hpp"
#include "test/simulated_setup.hpp"

namespace fleetloc {

/// Laps of a simulated flight, one after another, however many: the measurements of the first lap
/// with later stamps. Landmarks have other ids in each lap, so that all tracks end with it. Its
/// memory does not depend on the number of laps.
class LoopedFlight final : public SensorSource {
 public:
  explicit LoopedFlight(std::size_t frame_count) : run_(one_lap()), frame_count_(frame_count) {
    const auto end = Timestamp{from_seconds(kLapSeconds)};
    for (int i = 0; run_.frame_stamp(i) < end; ++i) {
      frames_.push_back(run_.frame(i));
      for (const StereoObservation& seen : frames_.back().observations) {
        ids_of_lap_ = std::max(ids_of_lap_, static_cast<std::uint32_t>(seen.landmark) + 1);
      }
    }
    imu_ = run_.imu(Timestamp{}, end - Duration(1));
  }

  /// An IMU sample comes before a frame of the same stamp; one after the last frame ends it.
  std::optional<SensorMeasurement> next(const std::stop_token& stop) override {
    if (stop.stop_requested() || is_finished_) return std::nullopt;
    const Timestamp frame_stamp = frames_[next_frame_ % frames_.size()].stamp + lap_of(next_frame_);
    ImuSample sample = imu_[next_sample_ % imu_.size()];
    sample.stamp += from_seconds(kLapSeconds) * (next_sample_ / imu_.size());
    is_finished_ = next_frame_ == frame_count_;
    if (is_finished_ || sample.stamp <= frame_stamp) {
      ++next_sample_;
      return sample;
    }
    TrackedFrame frame = frames_[next_frame_ % frames_.size()];
    frame.stamp = frame_stamp;
    const auto lap = static_cast<std::uint32_t>(next_frame_ / frames_.size());
    for (StereoObservation& seen : frame.observations) {
      seen.landmark = LandmarkId{static_cast<std::uint32_t>(seen.landmark) + lap * ids_of_lap_};
    }
    ++next_frame_;
    return CameraFrame(std::move(frame));
  }
  using SensorSource::next;

  [[nodiscard]] std::optional<std::size_t> frame_count() const override { return frame_count_; }
  std::map<std::string, std::uint64_t> close() override { return {}; }

  [[nodiscard]] const SimulatedRun& run() const { return run_; }
  /// T_room_body.
  [[nodiscard]] Pose truth(Timestamp stamp) const {
    const Duration since_lap = (stamp - Timestamp{}) % from_seconds(kLapSeconds);
    return run_.truth(Timestamp{since_lap}).T_odom_body;
  }

 private:
  static constexpr double kLapSeconds = 20.0;

  /// At a speed with which a round takes a lap exactly.
  static SimulatedRun::Config one_lap() {
    SimulatedRun::Config config = noisy_flight();
    config.rest_s = 0.0;
    config.imu_bias_walk = false;
    config.speed *= SimulatedRun(config).round_s() / kLapSeconds;
    return config;
  }
  [[nodiscard]] Duration lap_of(std::size_t frame) const {
    return from_seconds(kLapSeconds) * (frame / frames_.size());
  }

  SimulatedRun run_;
  std::size_t frame_count_;
  std::vector<TrackedFrame> frames_;  // of one lap, as is the IMU
  std::vector<ImuSample> imu_;
  std::uint32_t ids_of_lap_ = 0;
  std::size_t next_frame_ = 0;
  std::size_t next_sample_ = 0;
  bool is_finished_ = false;
};

}  // namespace fleetloc
