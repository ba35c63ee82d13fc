#include "deploy/play/player.hpp"

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <utility>

#include <spdlog/spdlog.h>

#include "deploy/play/default_sensors.hpp"
#include "robot/node/dataset_player.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/config/progress_line.hpp"
#include "shared/transport/ros2/ros2_profiles.hpp"

namespace fleetloc {
namespace {

SensorsConfig read_sensors(const PlayOptions& options) {
  SensorsConfig sensors =
      options.sensors ? read_sensors_config(*options.sensors)
                      : read_sensors_config(
                            ConfigReader::from_string(kDefaultSensors, "sensors-play.yaml"), {});
  if (options.domain) sensors.domain = *options.domain;
  load_ros2_profiles(sensors.qos);
  return sensors;
}

}  // namespace

Player::Player(const PlayOptions& options)
    : options_(options),
      sensors_(read_sensors(options)),
      first_(opened()),
      publisher_(sensors_, first_->calibration()) {}

std::unique_ptr<DatasetReader> Player::opened() const {
  return std::make_unique<DatasetReader>(DatasetReader::Options{
      .folder = options_.dataset, .start_s = options_.start_s, .duration_s = options_.duration_s});
}

// The recording's own stamps set the pace, not those that a fault has changed.
std::unique_ptr<SensorSource> Player::in_real_time(std::unique_ptr<DatasetReader> recording) const {
  const Timestamp start = recording->recording_start();
  auto played = std::make_unique<DatasetPlayer>(std::move(recording), options_.rate);
  if (!options_.faults) return played;
  return std::make_unique<FaultInjector>(std::move(played), start, *options_.faults);
}

void Player::run(const std::stop_token& stop) {
  spdlog::info("{} as {}, {} and {}, DDS domain {}",
               options_.dataset.string(),
               sensors_.left.topic.name,
               sensors_.right.topic.name,
               sensors_.imu.name,
               sensors_.domain);
  wait_for_readers(stop);
  do {
    const auto recording = in_real_time(first_ ? std::move(first_) : opened());
    spdlog::info("playing");
    play(*recording, stop);
  } while (options_.loop && !stop.stop_requested());
  const SensorPublisher::Counts& counts = publisher_.counts();
  spdlog::info("published {} left and {} right images, {} IMU samples",
               counts.left,
               counts.right,
               counts.imu);
  if (counts.refused > 0) spdlog::warn("{} messages refused by the QoS limits", counts.refused);
  constexpr std::chrono::seconds kLast(2);
  if (!stop.stop_requested() && !publisher_.wait_for_acknowledgments(kLast)) {
    spdlog::warn("a reader has not acknowledged the last messages");
  }
}

void Player::wait_for_readers(const std::stop_token& stop) {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::milliseconds kLook(10);
  const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                      std::chrono::duration<double>(options_.wait_s));
  std::mutex mutex;
  std::condition_variable_any never;  // only a stop ends a wait early
  while (!publisher_.has_readers() && Clock::now() < end && !stop.stop_requested()) {
    publisher_.publish_camera_info(first_->recording_start());
    std::unique_lock lock(mutex);
    never.wait_for(lock, stop, kLook, [] { return false; });
  }
  if (options_.wait_s > 0.0 && !publisher_.has_readers()) {
    spdlog::warn("nobody reads all topics after {} s", options_.wait_s);
  }
}

void Player::play(SensorSource& recording, const std::stop_token& stop) {
  ++loops_;
  ProgressLine progress(options_.loop ? "loop " + std::to_string(loops_) : "playing");
  std::size_t frames = 0;
  while (const auto measurement = recording.next(stop)) {
    publisher_.publish(*measurement);
    if (!std::holds_alternative<CameraFrame>(*measurement)) continue;
    ++frames;
    if (const auto total = recording.frame_count()) progress.show(frames, *total);
  }
  for (const auto& [kind, count] : recording.close()) {
    if (count > 0) spdlog::info("{} times {}", count, kind);
  }
}

}  // namespace fleetloc
