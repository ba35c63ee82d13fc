#include "cloud/node/map_publisher.hpp"

#include <chrono>

#include "cloud/point_cloud/voxel_cloud.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/ros2/point_cloud_codec.hpp"
#include "shared/ros2/ros2_names.hpp"
#include "shared/transport/ros2/ros2_profiles.hpp"
#include "shared/transport/transport_error.hpp"

namespace fleetloc {
namespace {

constexpr std::size_t kMaxPoints = 1'000'000;  // 12 MB

std::uint32_t domain_with_ros2_profiles(const MapPublisher::Config& config) {
  load_ros2_profiles();
  return static_cast<std::uint32_t>(config.domain);
}

}  // namespace

MapPublisher::MapPublisher(const LaserMap& map, double voxel_m, const Config& config)
    : participant_(domain_with_ros2_profiles(config)),
      writer_(participant_.create_writer({.name = "rt" + config.topic,
                                          .type = ros2_type::kPointCloud,
                                          .qos = Ros2Qos::kLatched})) {
  VoxelCloud thinned(voxel_m, kMaxPoints);
  for (const MapPoint& point : map.points()) thinned.add(point.p_map.cast<double>());
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  const PointCloudMessage message{.header = {.stamp = Timestamp{now}, .frame = config.frame},
                                  .points = thinned.points()};
  points_ = message.points.size();
  if (!writer_.write(encode(message))) throw TransportError("the map could not be published");
}

MapPublisher::Config read_map_publisher_config(ConfigReader section) {
  constexpr int kMaxDomain = 100;  // beyond, Linux may give its ports to others
  MapPublisher::Config config{.domain = section.integer("domain", 0, kMaxDomain),
                              .topic = section.get<std::string>("map_topic"),
                              .frame = section.get<std::string>("map_frame")};
  if (config.topic.size() < 2 || config.topic.front() != '/') {
    section.fail("map_topic", "'" + config.topic + "' is not a topic of ROS, such as /map_points");
  }
  return config;
}

}  // namespace fleetloc
