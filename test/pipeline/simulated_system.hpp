#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "cloud/laser_map/build_map.hpp"
#include "deploy/replay/simulated_cloud.hpp"
#include "shared/link/memory_network.hpp"
#include "test/pipeline/simulated_robot.hpp"

namespace fleetloc {

/// The map of the simulated room; the map's frame is the room's.
inline std::shared_ptr<const LaserMap> map_of(const SimulatedRun& run) {
  std::vector<Eigen::Vector3f> points;
  for (const Eigen::Vector3d& p : run.surface_points(0.03)) points.push_back(p.cast<float>());
  return std::make_shared<const LaserMap>(
      build_map(points, "map", read_map_config(defaults().section("map"))));
}

/// A robot and a localizer over a link, in simulated time and on simulated tracks.
class SimulatedSystem {
 public:
  SimulatedSystem(const SimulatedRun& run,
                  std::shared_ptr<const LaserMap> map,
                  const LinkConfig& link,
                  const std::optional<Pose>& T_map_body_start,
                  std::shared_ptr<const MapPyramid> pyramid = nullptr)
      : network_(link),
        robot_end_(network_.join_robot("robot")),
        cloud_end_(network_.join_cloud("localizer")),
        cloud_(LocalizerPool("localizer",
                             Incarnation{1},
                             std::move(map),
                             read_localizer_pool_config(defaults()),
                             std::move(pyramid)),
               *cloud_end_,
               std::chrono::milliseconds(50),
               {}),
        robot_(run, *robot_end_, T_map_body_start) {}

  /// Plays everything up to `seconds`.
  void play(double seconds) {
    robot_.play(seconds, [this](Timestamp now) { cloud_.advance(now); });
  }

  [[nodiscard]] const SimulatedRobot& robot() const { return robot_; }
  SimulatedRobot& robot() { return robot_; }
  [[nodiscard]] const LocalizerPool& pool() const { return cloud_.pool(); }

 private:
  MemoryNetwork network_;
  std::unique_ptr<Channel> robot_end_;
  std::unique_ptr<Channel> cloud_end_;
  SimulatedCloud cloud_;
  SimulatedRobot robot_;  // last: it uses its end of the network
};

}  // namespace fleetloc
