#pragma once

#include <array>
#include <cstdint>
#include <filesystem>

#include "deploy/evaluation/experiment/plan.hpp"
#include "shared/core/time.hpp"

namespace fleetloc {

/// Displacement of a start pose from the truth: x, y, z in map [m] and yaw [deg]. Direction and
/// sign are drawn by the seed; a third of the distance is vertical.
std::array<double, 4> start_displacement(const StartError& error, std::uint64_t seed);

/// Stamp of the first frame that is not before `start_s` of a recording.
/// @param index  mav0/cam0/data.csv or mav0/tracks0/data.csv
/// Throws std::runtime_error if there is none.
Timestamp first_frame(const std::filesystem::path& index, double start_s);

}  // namespace fleetloc
