#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "robot/live/sensors_config.hpp"
#include "robot/sensors/sensor_source.hpp"
#include "shared/model/camera.hpp"
#include "shared/ros2/camera_info_codec.hpp"
#include "shared/transport/ros2/ros2_participant.hpp"

namespace fleetloc {

/// Publishes measurements as the drivers of cameras and IMU would, on the topics of ROS 2 that a
/// robot's sensors.yaml names, with the QoS that the robot asks for: images as mono8 or JPEG, IMU
/// samples, and, where the robot waits for it, CameraInfo with each image.
class SensorPublisher {
 public:
  /// What has been published.
  struct Counts {
    std::uint64_t left = 0;
    std::uint64_t right = 0;
    std::uint64_t imu = 0;
    std::uint64_t camera_info = 0;  ///< of both cameras
    std::uint64_t refused = 0;      ///< by the QoS limits
  };

  /// Throws TransportError, and ConfigError where the robot expects rectified images.
  /// @param calibration  of the images, as CameraInfo tells it
  SensorPublisher(const SensorsConfig& config, const StereoCalibration& calibration);

  /// A missing image is not published; tracks and clock steps are nothing that a driver sends.
  void publish(const SensorMeasurement& measurement);

  /// CameraInfo without an image: a robot reads images only when it knows their calibration.
  void publish_camera_info(Timestamp stamp);

  /// Whether somebody reads each of the topics of images and IMU.
  [[nodiscard]] bool has_readers() const;

  /// Until reliable readers have everything. False if that takes longer than `max_wait` for one.
  bool wait_for_acknowledgments(std::chrono::milliseconds max_wait);

  [[nodiscard]] const Counts& counts() const { return counts_; }

 private:
  struct InfoTopic {
    Ros2Writer topic;
    CameraInfoMessage message;
  };
  struct CameraTopics {
    Ros2Writer images;
    ImageTransport transport;
    std::string frame;
    std::optional<InfoTopic> info;
  };

  CameraTopics camera_topics(const ImageTopic& images, std::string frame);
  void publish(CameraTopics& camera, Timestamp stamp, const cv::Mat& gray, std::uint64_t& count);
  void publish_info(CameraTopics& camera, Timestamp stamp);
  [[nodiscard]] std::vector<Ros2Writer*> writers();
  void write(Ros2Writer& writer, Bytes message, std::uint64_t& count);

  Ros2Participant participant_;
  CameraTopics left_;
  CameraTopics right_;
  Ros2Writer imu_;
  Counts counts_;
};

}  // namespace fleetloc
