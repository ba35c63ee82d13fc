#pragma once

#include <string>

#include "shared/core/time.hpp"

namespace fleetloc {

/// std_msgs/Header: when, and in which frame's coordinates.
struct Ros2Header {
  Timestamp stamp;
  std::string frame;
};

}  // namespace fleetloc
