#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "robot/live/sensors_config.hpp"
#include "robot/runtime/robot_sink.hpp"
#include "shared/transport/ros2/ros2_participant.hpp"

namespace fleetloc {

/// Says at which of the stamps that come something is due that has a rate of its own.
class Rate {
 public:
  /// @param rate_hz  0: never
  explicit Rate(double rate_hz);

  /// Once an interval of the stamps; anew when the clock was set.
  bool is_due(Timestamp stamp);

 private:
  std::optional<Duration> interval_;
  std::optional<Timestamp> next_;
};

/// Publishes a robot's poses as topics of ROS 2: nav_msgs/Odometry, the pose in the map with its
/// covariance at each frame, and tf: odom -> base and, from the first pose in the map on,
/// map -> odom. Nothing while there is no pose. On loopback no write waits for anybody.
class Ros2Output final : public RobotSink {
 public:
  /// Throws TransportError.
  /// @param participant  outlives this
  Ros2Output(const SensorsConfig& config, Ros2Participant& participant);

  void add(const RobotOutput& output) override;
  /// Whether somebody reads each of the topics.
  [[nodiscard]] bool has_readers() const;
  /// "unpublished_ros2_messages": refused by the QoS limits.
  [[nodiscard]] std::map<std::string, std::uint64_t> faults() const override;

 private:
  void publish(const PoseEstimate& pose);
  void write(Ros2Writer& writer, Bytes message);

  RosFrames frames_;
  Rate odometry_rate_;
  Rate odom_base_rate_;
  Rate map_odom_rate_;
  Ros2Writer odometry_;
  Ros2Writer map_pose_;
  Ros2Writer tf_;
  std::uint64_t unpublished_ = 0;
};

}  // namespace fleetloc
