#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "shared/core/ids.hpp"
#include "shared/model/localization_result.hpp"
#include "shared/model/robot_status.hpp"
#include "shared/model/served_robot.hpp"

namespace fleetloc {

/// Events per second over the latest seconds: older ones count less and less.
class DecayingRate {
 public:
  void add(double amount, Timestamp now);
  [[nodiscard]] double per_second(Timestamp now) const;

 private:
  double per_second_ = 0.0;  // at that time
  Timestamp at_{};
};

/// The robots of a localizer as those see them who watch the fleet.
class ServedRobots {
 public:
  explicit ServedRobots(std::string localizer) : localizer_(std::move(localizer)) {}

  /// A session, which replaces the one before.
  void open(const RobotId& robot, SessionNumber session, Timestamp now);
  void erase(const RobotId& robot) { robots_.erase(robot); }

  /// What follows is left out for a robot without a session.
  void received(const RobotId& robot, std::size_t payload_bytes, Timestamp now);
  void sent(const RobotId& robot, std::size_t payload_bytes, Timestamp now);
  void told(const RobotStatus& status);
  void answered(const RobotId& robot, const LocalizationResult& answer);
  /// Where it may be, the likeliest place first; empty where that is not the question.
  void searched(const RobotId& robot, std::vector<Eigen::Vector3d> possible_places);

  [[nodiscard]] std::vector<ServedRobot> all(Timestamp now) const;

 private:
  struct Robot {
    ServedRobot known;
    Timestamp heard;
    DecayingRate up, down;  // bytes on the wire
  };

  std::string localizer_;
  std::map<RobotId, Robot> robots_;
};

}  // namespace fleetloc
