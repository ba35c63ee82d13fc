#pragma once

#include <optional>

#include "shared/model/session.hpp"

namespace fleetloc {

/// What a RobotSession sample means beside the one that is in force.
enum class SessionVerdict {
  kRepeated,  ///< the same session again, perhaps with a newer start pose
  kReplaces,  ///< the robot was restarted, or its odometry was reset
  kOutdated,  ///< an old sample that must not bring an old session back
};

/// A later start of the program wins; within one run of the program the higher session number.
SessionVerdict judge(const std::optional<RobotSession>& current, const RobotSession& sample);

}  // namespace fleetloc
