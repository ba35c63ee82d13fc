#pragma once

#include <optional>
#include <vector>

#include "cloud/locate/place_search.hpp"
#include "shared/config/config_reader.hpp"

namespace fleetloc {

/// Which landmarks lie on the ground: as far below the camera as most of those near it.
struct GroundConfig {
  double near_m;     ///< horizontally; landmarks within it tell the camera's height
  double band_m;     ///< height of the band that holds the most of them
  double min_share;  ///< of the landmarks nearby, which that band must hold
  double max_slope;  ///< of the ground, away from the camera
};

/// Of the camera above the ground [m]; nothing if no level below it stands out.
std::optional<double> camera_height(const std::vector<SeenLandmark>& landmarks,
                                    const GroundConfig& config);

/// Those that are not on the ground, which is everywhere and tells of no place; all of them if it
/// is not known where the ground is.
std::vector<SeenLandmark> above_ground(const std::vector<SeenLandmark>& landmarks,
                                       const GroundConfig& config);

/// One of those in each block of space with edges of `spacing_m`, the first one: what stands
/// together is one thing, which may be gone, however many landmarks it has.
std::vector<SeenLandmark> spread_out(const std::vector<SeenLandmark>& landmarks, double spacing_m);

GroundConfig read_ground_config(ConfigReader section);

}  // namespace fleetloc
