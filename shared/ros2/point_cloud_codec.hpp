#pragma once

#include <vector>

#include <Eigen/Core>

#include "shared/link/channel.hpp"
#include "shared/ros2/ros2_header.hpp"

namespace fleetloc {

/// sensor_msgs/PointCloud2 with the fields x, y, z in single precision.
struct PointCloudMessage {
  Ros2Header header;
  std::vector<Eigen::Vector3f> points;  ///< in the header's frame [m], all finite
};

Bytes encode(const PointCloudMessage& message);

}  // namespace fleetloc
