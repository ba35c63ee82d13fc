#pragma once

#include <filesystem>
#include <string>

#include <unistd.h>

namespace fleetloc {

/// An empty folder of this process alone, removed at its end: tests run side by side.
inline const std::filesystem::path& test_folder() {
  struct Folder {
    Folder() { std::filesystem::create_directories(path); }
    ~Folder() {
      std::error_code ignored;
      std::filesystem::remove_all(path, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;

    std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("fleetloc_test_" + std::to_string(::getpid()));
  };
  static const Folder folder;
  return folder.path;
}

}  // namespace fleetloc
