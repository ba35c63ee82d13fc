#pragma once

#include <filesystem>

#include "shared/config/delimited_file.hpp"
#include "shared/dataset/dataset_error.hpp"

namespace fleetloc {

/// A list of a recording, fields separated by commas. Throws DatasetError if it cannot be read.
inline DelimitedFile open_csv(const std::filesystem::path& file) {
  try {
    return {file, ','};
  } catch (const TextFileError& error) {
    throw DatasetError(error.what());
  }
}

}  // namespace fleetloc
