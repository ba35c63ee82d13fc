#pragma once

#include "test/system/recorded_flight.hpp"

namespace fleetloc {

// Made once and kept in the build tree, until one of the programs that make them changes; who asks
// meanwhile waits. Ten rendered stereo pairs a second, an IMU, ground truth and a map. Shorter with
// sanitizers. Throw std::runtime_error with what a program said.

/// 44 s through a furnished room, hand-held, from rest; walls and furniture as a laser sees them.
RecordedFlight simulated_room();
/// 24 s along a street of the campus in autumn, from rest; the map is a survey's, in summer.
RecordedFlight simulated_street();
/// A robot that stands at the begin of that street for 40 s, and then drives along it for 12 s.
RecordedFlight simulated_parked();

}  // namespace fleetloc
