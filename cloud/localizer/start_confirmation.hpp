#pragma once

#include <optional>

#include "shared/config/config_reader.hpp"
#include "shared/geometry/pose.hpp"

namespace fleetloc {

/// Accepts the first localization of a session only once it is confirmed. In a scene that has
/// changed a lot, a wrong pose may have enough matches by chance; but as the robot drives on and
/// observes other structure, a wrong T_map_odom changes and the right one stays.
class StartConfirmation {
 public:
  struct Config {
    double path_m;       ///< over which T_map_odom must stay
    double tolerance_m;  ///< of the position, within which it stays
  };

  explicit StartConfirmation(const Config& config) : config_(config) {}

  /// Takes the session's next solution, in the order of its keyframes.
  /// @param travelled_m  by the odometry until then
  /// @param is_confident      the solution needs no confirmation
  /// @return whether this solution and those that follow are accepted
  bool take(const Pose& T_map_body, const Pose& T_odom_body, double travelled_m, bool is_confident);

  /// Of the last solution; nothing once the session is confirmed.
  [[nodiscard]] const std::optional<Pose>& last_T_map_odom() const { return last_T_map_odom_; }

 private:
  struct Candidate {
    Pose T_map_odom;
    double travelled_m;
  };

  Config config_;
  bool confirmed_ = false;
  std::optional<Candidate> candidate_;
  std::optional<Pose> last_T_map_odom_;
};

StartConfirmation::Config read_start_confirmation_config(ConfigReader section);

}  // namespace fleetloc
