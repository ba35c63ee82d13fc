#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "test/training/bit_record.hpp"

namespace fleetloc {

/// The blocks of a drive, as `fleetloc-replay --samples` has written them down.
struct Recording {
  std::string name;
  std::vector<BitRecord> blocks;
};

/// Decoded with the models of this build, which must be those of the recording.
/// Throws std::runtime_error for a file that cannot be read or a sample that cannot be decoded.
Recording read_recording(const std::filesystem::path& file);

}  // namespace fleetloc
