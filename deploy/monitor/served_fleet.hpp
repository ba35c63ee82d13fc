#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "deploy/monitor/fleet_view.hpp"
#include "shared/core/arrival_time.hpp"
#include "shared/model/served_robot.hpp"
#include "shared/model/session.hpp"

namespace fleetloc {

/// The fleet as its localizers tell it. Localizers are gone after five seconds of silence, and so
/// are the robots that nobody else tells of; a robot whose localizer has not heard of it for thirty
/// seconds is, too. Of a robot that two localizers know, during a handover,
/// what the one says that has heard of it last.
class ServedFleet {
 public:
  void add(const ServedRobot& robot, ArrivalTime now);
  void add(const LocalizerStatus& localizer, ArrivalTime now);
  void forget_silent(ArrivalTime now);

  /// By name.
  [[nodiscard]] std::vector<ServedRobot> robots() const;
  [[nodiscard]] std::vector<LocalizerStatus> localizers() const;

 private:
  template <typename T>
  struct Heard {
    T news;
    ArrivalTime at;
  };

  std::map<std::pair<RobotId, std::string>, Heard<ServedRobot>> robots_;  // by robot and localizer
  std::map<std::string, Heard<LocalizerStatus>> localizers_;
};

/// For table() and line(); what localizers do not know is not known.
FleetView view_of(const ServedFleet& fleet);

/// For the page: `robots` and `localizers`, SI units, angles in radians, null where something is
/// not known. An ellipse is of one sigma of the horizontal position: its half axes [m], the first
/// one's direction in the map [rad].
std::string json_of(const ServedFleet& fleet);

}  // namespace fleetloc
