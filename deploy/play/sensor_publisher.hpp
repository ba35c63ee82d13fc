#pragma once

#include <array>
#include <chrono>
#include <cstdint>

#include "robot/live/sensors_config.hpp"
#include "robot/sensors/sensor_source.hpp"
#include "shared/transport/ros2/ros2_participant.hpp"

namespace fleetloc {

/// Publishes measurements as the drivers of cameras and IMU would: mono8 images and IMU samples on
/// the topics of ROS 2 that a robot's sensors.yaml names, with the QoS that the robot asks for.
class SensorPublisher {
 public:
  /// What has been published.
  struct Counts {
    std::uint64_t left = 0;
    std::uint64_t right = 0;
    std::uint64_t imu = 0;
    std::uint64_t refused = 0;  ///< by the QoS limits
  };

  /// Throws TransportError, and ConfigError where the robot expects compressed images.
  explicit SensorPublisher(const SensorsConfig& config);

  /// A missing image is not published; tracks and clock steps are nothing that a driver sends.
  void publish(const SensorMeasurement& measurement);

  /// Whether somebody reads each of the topics.
  [[nodiscard]] bool has_readers() const;

  /// Until reliable readers have everything. False if that takes longer than `max_wait` for one.
  bool wait_for_acknowledgments(std::chrono::milliseconds max_wait);

  [[nodiscard]] const Counts& counts() const { return counts_; }

 private:
  void publish(const StereoFrame& frame);
  void write(Ros2Writer& writer, Bytes message, std::uint64_t& count);

  Ros2Participant participant_;
  Ros2Writer left_;
  Ros2Writer right_;
  Ros2Writer imu_;
  Counts counts_;
};

}  // namespace fleetloc
