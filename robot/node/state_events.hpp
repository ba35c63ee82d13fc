#pragma once

#include <optional>
#include <string>
#include <vector>

#include "robot/runtime/robot_sink.hpp"

namespace fleetloc {

/// What a log is told of a robot's state: that it has changed, once the new one has lasted for a
/// second, and, while the robot is not localized, why the localizer cannot say where it is.
///
/// No clock, no I/O.
class StateEvents {
 public:
  /// @return what is new with this output, such as "state: lost"
  std::vector<std::string> add(const RobotOutput& output);

 private:
  std::optional<std::string> state_with(const FrameOutput& frame);
  std::optional<std::string> reason_in(const LocalizationOutput& answer);

  Quality told_ = Quality::kInitializing;
  Quality latest_ = Quality::kInitializing;
  Timestamp since_;                           // the first frame with the latest one
  std::optional<LocalizationStatus> reason_;  // that was told last
  Timestamp reason_told_;
};

}  // namespace fleetloc
