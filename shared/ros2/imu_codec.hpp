#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "shared/link/channel.hpp"
#include "shared/model/inertial.hpp"
#include "shared/ros2/ros2_refusal.hpp"

namespace fleetloc {

/// sensor_msgs/Imu without its orientation, which is not read.
struct ImuMessage {
  std::string frame;  ///< that of the IMU
  ImuSample sample;
};

/// Says that there is no orientation, and that the noise is unknown. Writes what it is given, also
/// what is not finite: that is how a faulty driver is played.
Bytes encode(const ImuMessage& message);

/// Finite, at most 1000 rad/s and 10,000 m/s^2. Never throws.
Ros2Decoded<ImuMessage> decode_imu(std::span<const std::uint8_t> bytes);

}  // namespace fleetloc
