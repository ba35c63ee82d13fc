#pragma once

#include <deque>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>

#include "deploy/monitor/line_tail.hpp"
#include "shared/trajectory/trajectory.hpp"

namespace fleetloc {

/// State of a robot, by its run folder; NaN: not known.
struct RobotView {
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

  std::string name;
  double time_s = kUnknown;  ///< since its first frame
  std::string state;         ///< empty: no frame so far
  double error_m = kUnknown;
  double sigma_m = kUnknown;  ///< of the position, along the least certain direction
  double uplink_kb_s = kUnknown;
  double downlink_kb_s = kUnknown;
  double round_trip_s = kUnknown;
  bool ended = false;
};

/// State of a localizer, by its status.csv.
struct LocalizerView {
  std::string name;
  std::string state;     ///< accepting, full or draining
  std::string sessions;  ///< empty: nothing written so far
  double load = 0.0;
  std::string submaps;
  std::string localized;
};

/// Follows a run folder while a robot writes it.
class WatchedRun {
 public:
  /// @param truth  of T_map_body; empty: errors are not known
  WatchedRun(const std::filesystem::path& folder, Trajectory truth);

  /// Reads what is new.
  const RobotView& update();

 private:
  struct Traffic {
    double time_s = 0.0;
    double uplink_bytes = 0.0;
    double downlink_bytes = 0.0;
  };

  void read_diagnostics();
  void read_error();
  void add(const Traffic& traffic);

  std::filesystem::path summary_;
  Trajectory truth_;
  CsvTail diagnostics_;
  LineTail poses_;
  std::optional<double> first_stamp_s_;
  std::deque<Traffic> traffic_;  // of the latest seconds
  RobotView view_;
};

class WatchedLocalizer {
 public:
  explicit WatchedLocalizer(const std::filesystem::path& folder);

  /// Reads what is new.
  const LocalizerView& update();

 private:
  CsvTail status_;
  LocalizerView view_;
};

}  // namespace fleetloc
