#pragma once

#include <cstdint>
#include <string>

#include "cloud/laser_map/laser_map.hpp"
#include "shared/transport/ros2/ros2_participant.hpp"

namespace fleetloc {

class ConfigReader;

/// Shows the laser map to programs of ROS 2 on this computer, as RViz: a latched PointCloud2, one
/// point for each voxel, which those get, too, that start later.
class MapPublisher {
 public:
  struct Config {
    int domain;         ///< of ROS 2 (ROS_DOMAIN_ID), not of the fleet
    std::string topic;  ///< as ROS writes it
    std::string frame;
  };

  /// Publishes it. Throws TransportError.
  /// @param voxel_m  edge; larger where the map is too large to be shown
  MapPublisher(const LaserMap& map, double voxel_m, const Config& config);

  [[nodiscard]] std::size_t points() const { return points_; }

 private:
  Ros2Participant participant_;
  Ros2Writer writer_;
  std::size_t points_ = 0;
};

MapPublisher::Config read_map_publisher_config(ConfigReader section);

}  // namespace fleetloc
