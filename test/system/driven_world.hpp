#pragma once

#include <filesystem>

#include "test/system/recorded_flight.hpp"

namespace fleetloc {

/// A simulated campus: the laser map of the streets around a block, and the tracks of two drives on
/// them, one in each direction.
struct DrivenWorld {
  std::filesystem::path map;
  RecordedFlight forward;
  RecordedFlight reverse;

  /// Made once and kept in the build tree, until one of the programs that make it changes; locked
  /// meanwhile. Throws std::runtime_error with what a program said.
  /// @param min_s  length of the drives, in laps of 108 s
  static DrivenWorld kept(double min_s = 100.0);

  /// Tracks of another drive forwards, of 100 s, in which somebody carries the robot from where it
  /// is at `at_s` to where it is at `to_s`, and no sensor takes notice. Kept as well.
  static RecordedFlight carried(int at_s, int to_s);
};

}  // namespace fleetloc
