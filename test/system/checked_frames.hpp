#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "shared/core/time.hpp"
#include "test/system/recorded_flight.hpp"

namespace fleetloc {

/// What is said of the position in the map at one frame, and how far off it is.
struct CheckedFrame {
  Timestamp stamp;  ///< by the clock of the ground truth
  std::string state;
  double error_m = 0.0;
  double sigmas = 0.0;  ///< of the error, by the covariance that was stated with it
};

/// Frames of a run folder that have a pose in the map, against the ground truth.
/// @param clock_steps  by which the robot's clock was set during the run, one after the other, each
///     by more than 5 s
std::vector<CheckedFrame> checked_frames(const std::filesystem::path& run,
                                         const RecordedFlight& flight,
                                         const std::vector<Duration>& clock_steps = {});

/// Fails the test if a frame that is called localized is off by more than 0.5 m and 3 sigmas.
/// @return the largest error of those that are called localized [m]
double worst_while_localized(const std::vector<CheckedFrame>& frames);

}  // namespace fleetloc
