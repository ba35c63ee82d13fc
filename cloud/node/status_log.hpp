#pragma once

#include <filesystem>
#include <fstream>
#include <optional>

#include "cloud/pool/localizer_pool.hpp"

namespace fleetloc {

/// status.csv of a localizer: a line each second, for monitoring, and as a record if the process is
/// killed. `time_s` since the start, `sessions` now, `load` 0..1, then counts since the start over
/// all robots in sessions.json; `state` accepting, full or draining. Beyond 20 MB, which is about a
/// week, and when it is asked to, it begins anew; the one before stays as status.csv.1.
class StatusLog {
 public:
  /// Throws std::runtime_error that names the file.
  StatusLog(const std::filesystem::path& file, Timestamp start);

  /// Writes a line if one is due. Throws as the constructor.
  void add(const LocalizerPool& pool, double load, Timestamp now);

  /// Throws as the constructor.
  void begin_anew();

 private:
  void open();

  std::filesystem::path file_;
  std::ofstream stream_;
  Timestamp start_;
  std::optional<Timestamp> written_;
};

}  // namespace fleetloc
