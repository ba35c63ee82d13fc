#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <stop_token>

#include "deploy/faults/fault_injector.hpp"
#include "deploy/play/sensor_publisher.hpp"
#include "robot/dataset/dataset_reader.hpp"

namespace fleetloc {

struct PlayOptions {
  std::filesystem::path dataset;
  std::optional<std::filesystem::path> sensors;  ///< topics; else those of sensors-play.yaml
  std::optional<int> domain;                     ///< of ROS 2, instead of the one in that file
  double rate = 1.0;                             ///< of the recording's time, above 0
  bool loop = false;                             ///< from the start again until it is stopped
  double wait_s = 0.0;                           ///< for readers, before it begins
  double start_s = 0.0;                          ///< of the recording to skip
  std::optional<double> duration_s;              ///< of the recording to play
  std::optional<FaultPlan> faults;
};

/// Stands in for a robot's drivers: publishes a recording in real time. Each loop has the stamps of
/// the recording, as with `ros2 bag play --loop`: the clock is set back between them.
class Player {
 public:
  /// Throws DatasetError, ConfigError, TransportError.
  explicit Player(const PlayOptions& options);

  /// Until the recording ends or a stop is requested. Says what has been published.
  void run(const std::stop_token& stop);

 private:
  [[nodiscard]] std::unique_ptr<DatasetReader> opened() const;
  [[nodiscard]] std::unique_ptr<SensorSource> in_real_time(
      std::unique_ptr<DatasetReader> recording) const;
  void wait_for_readers(const std::stop_token& stop);
  void play(SensorSource& recording, const std::stop_token& stop);

  PlayOptions options_;
  SensorsConfig sensors_;
  std::unique_ptr<DatasetReader> first_;  // opened before it begins, so that errors come early
  SensorPublisher publisher_;
  std::uint64_t loops_ = 0;
};

}  // namespace fleetloc
