#pragma once

#include "robot/live/sensors_config.hpp"
#include "shared/transport/ros2/ros2_participant.hpp"

namespace fleetloc {

/// A robot's sensors on the wire.
Ros2Topic image_topic(const ImageTopic& topic);
Ros2Topic imu_topic(const RosTopic& topic);
Ros2Topic camera_info_topic(const RosTopic& topic);
Ros2Topic initial_pose_topic(const RosTopic& topic);

}  // namespace fleetloc
