#pragma once

#include <optional>

#include "shared/config/config_reader.hpp"
#include "shared/geometry/pose.hpp"

namespace fleetloc {

/// Whether the place where a session was first found can be trusted. Where most of what the robot
/// sees is new, chance finds surfaces for it beside the way as well as on it; but chance does not
/// last: as other surroundings come into view, a wrong place moves and the right one stays.
class StartConfirmation {
 public:
  struct Config {
    double path_m;       ///< over which the place must stay
    double tolerance_m;  ///< within which it stays
  };

  explicit StartConfirmation(const Config& config) : config_(config) {}

  /// Takes the session's next solution, in the order of its keyframes.
  /// @param travelled_m  by the odometry until then
  /// @param is_confident      the solution speaks for itself
  /// @return whether this solution and those that follow count
  bool take(const Pose& T_map_body, const Pose& T_odom_body, double travelled_m, bool is_confident);

  /// T_map_odom by the last solution, until the session is confirmed.
  [[nodiscard]] const std::optional<Pose>& last_place() const { return last_T_map_odom_; }

 private:
  struct Place {
    Pose T_map_odom;
    double travelled_m;
  };

  Config config_;
  bool confirmed_ = false;
  std::optional<Place> place_;
  std::optional<Pose> last_T_map_odom_;
};

StartConfirmation::Config read_start_confirmation_config(ConfigReader section);

}  // namespace fleetloc
