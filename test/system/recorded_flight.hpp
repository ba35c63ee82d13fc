#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "shared/core/time.hpp"
#include "test/system/child_program.hpp"

namespace fleetloc {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;  ///< about ten times slower
#else
inline constexpr bool kSanitized = false;
#endif

/// Throws std::runtime_error with what the program said, unless it ends well.
Outcome must_run(const std::string& program, const std::vector<std::string>& arguments);

/// Where recordings for tests lie: $RECORDINGS, else beside the source tree; never in it.
std::filesystem::path recordings();

/// A recorded dataset, and what tests need of it.
struct RecordedFlight {
  std::filesystem::path folder;
  std::filesystem::path ground_truth;
  std::filesystem::path map = {};  ///< of its place, where it comes with one

  /// For --initial-pose: the ground truth at the first frame from `start_s` on, displaced in the
  /// map by 0.3 m and 3 degrees of yaw.
  [[nodiscard]] std::string displaced_start_pose(double start_s = 0.0) const;
  /// The same at the very first frame, to the other side and turned the other way.
  [[nodiscard]] std::string start_pose_to_the_right() const;
};

/// The stamp of the first frame from `start_s` on, an image or its tracks. Throws
/// std::runtime_error if there is none.
Timestamp first_frame(const std::filesystem::path& dataset, double start_s = 0.0);

/// All real, hand-held, 17 s, no laser map.
RecordedFlight machine_hall();
/// Real IMU and room, rendered images, 50 s, with a laser scan.
RecordedFlight vicon_room();

/// Why nothing can be tried on the flight, for GTEST_SKIP.
std::optional<std::string> why_missing(const RecordedFlight& flight);

/// Of the flight's place: its own, or what fleetloc-map builds of its scan.
std::filesystem::path built_map(const RecordedFlight& flight, const ScratchFolder& scratch);

nlohmann::json parsed_json(const std::filesystem::path& file);

/// What fleetloc-eval prints: of one file, and of a run folder.
nlohmann::json odometry_errors(const std::filesystem::path& run, const RecordedFlight& flight);
nlohmann::json run_errors(const std::filesystem::path& run, const RecordedFlight& flight);

/// Lines of `file`, per frame of the run.
double share_of_frames(const std::filesystem::path& run, const std::string& file);

}  // namespace fleetloc
