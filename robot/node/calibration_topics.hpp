#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <string>

#include "robot/calibration/sensor_rig.hpp"
#include "robot/live/sensors_config.hpp"
#include "shared/ros2/camera_info_codec.hpp"
#include "shared/transport/ros2/ros2_participant.hpp"

namespace fleetloc {

/// Waits until CameraInfo of both cameras has come and can be used. Says what does not come within
/// `silence` of the config, and what is wrong with what comes. Nothing when a stop is requested.
/// @param config  its calibration is a CameraInfoSource
/// @param waiting  called again and again meanwhile
std::optional<SensorRig> calibration_from_topics(const SensorsConfig& config,
                                                 Ros2Participant& participant,
                                                 const std::function<void(const std::string&)>& say,
                                                 const std::stop_token& stop,
                                                 const std::function<void()>& waiting = {});

/// A CameraInfo as ROS 2 sends it, without its header.
/// @return nothing for an image that is binned or cut out: its K is not that of the whole image
std::optional<CameraInfo> whole_image_info(const CameraInfoMessage& message);

}  // namespace fleetloc
