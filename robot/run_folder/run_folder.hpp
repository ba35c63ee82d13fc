#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shared/config/output_folder.hpp"
#include "shared/core/histogram.hpp"
#include "shared/model/localization_result.hpp"
#include "shared/model/pose_estimate.hpp"

namespace fleetloc {

class ConfigReader;

/// One line of diagnostics.csv, and of the two trajectories at frame times.
struct FrameRecord {
  PoseEstimate pose;                 ///< at the frame's stamp; causal
  std::uint64_t uplink_bytes = 0;    ///< payload since the start
  std::uint64_t downlink_bytes = 0;  ///< payload since the start
  double loss = 0.0;
  std::optional<Duration> round_trip;
  int tracks = 0;
  bool keyframe = false;
  std::uint64_t resets = 0;  ///< of the odometry so far
};

/// One line of answers.csv.
struct AnswerRecord {
  Timestamp stamp;
  Timestamp arrival;
  std::string localizer;
  LocalizationStatus status{};
  std::string_view reason;  ///< name of the fusion's AnswerOutcome
  bool applied = false;
  /// Of a localized answer's pose from the one known before it, tangent of T_map_body.
  std::optional<Vector6d> innovation;
  int places = 0;  ///< at which the robot may be, if it is searched for
};

/// Content of summary.json; SI units unless a name says otherwise.
struct RunSummary {
  std::uint64_t frames = 0;
  std::uint64_t keyframes = 0;
  std::uint64_t submaps_sent = 0;
  std::uint64_t answers_received = 0;
  std::uint64_t answers_applied = 0;
  std::map<std::string, std::uint64_t> answers_rejected;  ///< by reason
  std::uint64_t corrections_applied = 0;
  std::uint64_t corrections_ignored = 0;
  std::uint64_t uplink_bytes = 0;
  std::uint64_t downlink_bytes = 0;
  std::uint64_t uplink_wire_bytes = 0;
  std::uint64_t downlink_wire_bytes = 0;
  std::uint64_t resets = 0;
  double standstill_s = 0.0;                          ///< for which the pose was held
  std::map<std::string, std::uint64_t> input_faults;  ///< of the dataset, by kind
  bool interrupted = false;  ///< by a signal or an error, before the end of the input
  double wall_s = 0.0;
  double cpu_s = 0.0;
  Histogram decode_ms;    ///< of each pair of images
  Histogram tracking_ms;  ///< of each frame
  Histogram backend_ms;   ///< of each keyframe
  double fusion_us_per_imu = 0.0;
  std::uint64_t max_rss_bytes = 0;
};

/// When the files of a folder go on in a new part.
struct RunParts {
  std::uint64_t max_bytes = 0;  ///< of all files of a part; 0: no limit
  Duration max_time{};          ///< of its frames; zero: no limit
  std::size_t kept = 1;         ///< earlier parts that stay; the oldest are deleted
};

RunParts read_run_parts(ConfigReader section);

/// The folder that a robot or a replay writes. All poses are causal: as known at that time. What
/// was written before the latest part is in the folder's part_000001, part_000002 and so on. What
/// an earlier run left there is written over, but for its parts, whose numbers go on.
class RunFolder {
 public:
  /// Creates the folder and its files; throws std::runtime_error that names what cannot be made, or
  /// the folder if another program is writing there.
  explicit RunFolder(const std::filesystem::path& folder, const RunParts& parts = {});

  /// What follows is a new part.
  void begin_part();

  /// Writes config.yaml.
  /// @param yaml  the configuration in force
  void write_config(const std::string& yaml) const;
  void add_imu_rate_pose(const PoseEstimate& pose);
  /// Throws std::runtime_error if what was recorded so far cannot be written, as on a full disk.
  void add_frame(const FrameRecord& frame);
  void add_answer(const AnswerRecord& answer);

  /// Writes summary.json, of all parts: the given figures, and those that follow from the records
  /// (frames, answers, duration, first pose, answer and localization, coverage). Then throws
  /// std::runtime_error if any file is not complete.
  void finish(RunSummary summary);

 private:
  void record_frame(const FrameRecord& frame);
  void count_coverage(const PoseEstimate& pose);
  void open();
  void flush();
  [[nodiscard]] bool is_part_complete();
  [[nodiscard]] std::filesystem::path part_folder(std::size_t number) const;
  [[nodiscard]] std::array<std::ofstream*, 5> streams();  // in the order of their names

  std::filesystem::path folder_;
  OutputFolder own_;
  RunParts parts_;
  std::size_t parts_before_ = 0;
  std::optional<Timestamp> first_frame_of_part_;
  std::ofstream odometry_;
  std::ofstream localization_;
  std::ofstream localization_frames_;
  std::ofstream diagnostics_;
  std::ofstream answers_;
  RunSummary counted_;  // what follows from the records
  std::optional<Timestamp> first_frame_;
  Timestamp last_frame_;
  std::optional<Timestamp> first_pose_;
  std::optional<Timestamp> first_answer_;
  std::optional<Timestamp> first_localization_;
  std::uint64_t frames_since_first_pose_ = 0;
  std::uint64_t covered_frames_ = 0;
};

}  // namespace fleetloc
