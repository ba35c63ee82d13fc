#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

#include "cloud/locate/map_pyramid.hpp"
#include "shared/core/expected.hpp"
#include "shared/core/ids.hpp"

namespace fleetloc {

/// A file that cannot be written.
struct PyramidFileError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// map.pyramid beside map.pcd.
std::filesystem::path pyramid_file(const std::filesystem::path& pcd_file);

/// Replaces the file as a whole, or leaves it as it was. Its first line says what it is; then,
/// little endian: the map's hash, the configuration, the ground, the grid, and a checksum of all
/// before it (XXH3, 64 bit).
/// @param map     hash of the map that the pyramid was made of
/// @throws PyramidFileError
void save_pyramid(const MapPyramid& pyramid,
                  const MapPyramid::Config& config,
                  const MapHash& map,
                  const std::filesystem::path& file);

/// @return the pyramid, or why the file is of no use: missing, damaged, of another map or of other
///         cells; names no file
expected<MapPyramid, std::string> load_pyramid(const std::filesystem::path& file,
                                               const MapHash& map,
                                               const MapPyramid::Config& config);

}  // namespace fleetloc
