#pragma once

#include <filesystem>

namespace fleetloc {

/// The folder that a program writes to. For as long as this lives, no other program on this
/// computer takes it for its own: two of them would mix their files, and both would succeed.
class OutputFolder {
 public:
  /// Creates it. Throws std::runtime_error that names it if it cannot be made, or is another's.
  /// Where the file system has no locks, nobody is kept out.
  explicit OutputFolder(const std::filesystem::path& folder);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

 private:
  int descriptor_;  // with the lock, which ends with the process in any case
};

}  // namespace fleetloc
