#include "robot/run_folder/run_folder.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "robot/run_folder/run_summary.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/geometry/angle.hpp"
#include "shared/trajectory/tum_file.hpp"

namespace fleetloc {
namespace {

constexpr const char* kOdometry = "odometry.tum";
constexpr const char* kLocalization = "localization.tum";
constexpr const char* kLocalizationFrames = "localization_frames.tum";
constexpr const char* kDiagnostics = "diagnostics.csv";
constexpr const char* kAnswers = "answers.csv";
constexpr std::array kFiles{
    kOdometry, kLocalization, kLocalizationFrames, kDiagnostics, kAnswers};  // of a part

constexpr const char* kSummary = "summary.json";
constexpr std::string_view kPart = "part_";

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kCoveredForSeconds =
    5.0;  // dead reckoning for less than this still counts as covered

std::ofstream opened(const std::filesystem::path& file) {
  std::ofstream stream(file);
  if (!stream) throw std::runtime_error(file.string() + ": cannot be written");
  return stream;
}

void append(std::string& line, const char* format, double value) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), format, value);
  line += text.data();
}

void append_upper_triangle(std::string& line, const Matrix6d& covariance, bool known) {
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) {
      append(line, ",%.9g", known ? covariance(row, column) : kNaN);
    }
  }
}

std::string triangle_header(const char* prefix) {
  std::string header;
  for (int row = 1; row <= 6; ++row) {
    for (int column = row; column <= 6; ++column) {
      header += "," + std::string(prefix) + std::to_string(row) + std::to_string(column);
    }
  }
  return header;
}

std::string diagnostics_line(const FrameRecord& frame) {
  const PoseEstimate& pose = frame.pose;
  std::string line = stamp_text(pose.stamp) + "," + std::string(name(pose.quality));
  append(line, ",%.6f", to_seconds(pose.since_last_answer));
  append_upper_triangle(line, pose.covariance_map, pose.T_map_body.has_value());
  append_upper_triangle(line, pose.covariance_odom, pose.quality != Quality::kInitializing);
  line += "," + std::to_string(frame.uplink_bytes) + "," + std::to_string(frame.downlink_bytes);
  append(line, ",%.4f", frame.loss);
  append(line, ",%.6f", frame.round_trip ? to_seconds(*frame.round_trip) : kNaN);
  line += "," + std::to_string(frame.tracks) + "," + (frame.keyframe ? "1" : "0");
  return line + "," + std::to_string(frame.resets) + "\n";
}

/// The largest number of a part in the folder; 0 without any.
std::size_t parts_in(const std::filesystem::path& folder) {
  std::size_t largest = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(kPart)) continue;
    std::size_t number = 0;
    const auto read =
        std::from_chars(name.data() + kPart.size(), name.data() + name.size(), number);
    if (read.ec == std::errc{} && read.ptr == name.data() + name.size()) {
      largest = std::max(largest, number);
    }
  }
  return largest;
}

}  // namespace

RunParts read_run_parts(ConfigReader section) {
  constexpr double kMaxMb = 1e9;
  constexpr double kMaxHours = 1e5;
  constexpr int kMaxParts = 100'000;
  return {.max_bytes = static_cast<std::uint64_t>(1e6 * section.number("part_mb", 0.0, kMaxMb)),
          .max_time = from_seconds(3600.0 * section.number("part_h", 0.0, kMaxHours)),
          .kept = static_cast<std::size_t>(section.integer("parts_kept", 0, kMaxParts))};
}

RunFolder::RunFolder(const std::filesystem::path& folder, const RunParts& parts)
    : folder_(folder), own_(folder), parts_(parts), parts_before_(parts_in(folder)) {
  std::filesystem::remove(folder_ / kSummary);  // of an earlier run; this one may be killed
  open();
}

void RunFolder::open() {
  odometry_ = opened(folder_ / kOdometry);
  localization_ = opened(folder_ / kLocalization);
  localization_frames_ = opened(folder_ / kLocalizationFrames);
  diagnostics_ = opened(folder_ / kDiagnostics);
  answers_ = opened(folder_ / kAnswers);
  diagnostics_ << "stamp_s,state,since_last_answer_s" << triangle_header("cm")
               << triangle_header("co")
               << ",uplink_bytes,downlink_bytes,loss,round_trip_s,tracks,keyframe,resets\n";
  answers_
      << "stamp_s,arrival_s,localizer,status,reason,applied,innovation_m,innovation_deg,places\n";
}

void RunFolder::begin_part() {
  flush();
  const auto part = part_folder(++parts_before_);
  std::filesystem::create_directories(part);
  for (const char* file : kFiles) std::filesystem::rename(folder_ / file, part / file);
  if (parts_before_ > parts_.kept) {
    std::filesystem::remove_all(part_folder(parts_before_ - parts_.kept));
  }
  first_frame_of_part_.reset();
  open();
}

std::filesystem::path RunFolder::part_folder(std::size_t number) const {
  std::array<char, 32> name{};
  std::snprintf(name.data(), name.size(), "%06zu", number);
  return folder_ / (std::string(kPart) + name.data());
}

bool RunFolder::is_part_complete() {
  const bool is_long =
      parts_.max_time > Duration{} && last_frame_ - *first_frame_of_part_ >= parts_.max_time;
  if (is_long || parts_.max_bytes == 0) return is_long;
  std::uint64_t bytes = 0;
  for (std::ofstream* stream : streams()) bytes += static_cast<std::uint64_t>(stream->tellp());
  return bytes >= parts_.max_bytes;
}

std::array<std::ofstream*, 5> RunFolder::streams() {
  return {&odometry_, &localization_, &localization_frames_, &diagnostics_, &answers_};
}

void RunFolder::write_config(const std::string& yaml) const {
  const auto file = folder_ / "config.yaml";
  std::ofstream stream = opened(file);
  stream << yaml;
  stream.close();
  if (!stream) throw std::runtime_error(file.string() + ": cannot be written");
}

void RunFolder::add_imu_rate_pose(const PoseEstimate& pose) {
  if (pose.T_map_body) write_tum_line(localization_, pose.stamp, *pose.T_map_body);
}

void RunFolder::add_frame(const FrameRecord& frame) {
  record_frame(frame);
  flush();
  if (is_part_complete()) begin_part();
}

void RunFolder::record_frame(const FrameRecord& frame) {
  const PoseEstimate& pose = frame.pose;
  ++counted_.frames;
  if (!first_frame_) first_frame_ = pose.stamp;
  if (!first_frame_of_part_) first_frame_of_part_ = pose.stamp;
  last_frame_ = pose.stamp;
  diagnostics_ << diagnostics_line(frame);
  if (pose.quality == Quality::kInitializing) return;
  if (!first_pose_) first_pose_ = pose.stamp;
  write_tum_line(odometry_, pose.stamp, pose.T_odom_body);
  count_coverage(pose);
  if (!pose.T_map_body) return;
  if (!first_localization_) first_localization_ = pose.stamp;
  write_tum_line(localization_frames_, pose.stamp, *pose.T_map_body);
}

// Whole lines, for the monitor and for runs that are killed.
void RunFolder::flush() {
  for (std::size_t i = 0; i < kFiles.size(); ++i) {
    if (streams()[i]->flush()) continue;
    throw std::runtime_error((folder_ / kFiles[i]).string() +
                             ": could not be written completely; is the disk full?");
  }
}

void RunFolder::count_coverage(const PoseEstimate& pose) {
  ++frames_since_first_pose_;
  const bool covered = pose.quality == Quality::kLocalized ||
                       (pose.quality == Quality::kDeadReckoning &&
                        to_seconds(pose.since_last_answer) < kCoveredForSeconds);
  if (covered) ++covered_frames_;
}

void RunFolder::add_answer(const AnswerRecord& answer) {
  ++counted_.answers_received;
  if (!first_answer_) first_answer_ = answer.arrival;
  const std::string status(name(answer.status));
  if (answer.applied) {
    ++counted_.answers_applied;
  } else {
    const bool localized = answer.status == LocalizationStatus::kLocalized;
    ++counted_.answers_rejected[localized ? std::string(answer.reason) : status];
  }
  std::string line = stamp_text(answer.stamp) + "," + stamp_text(answer.arrival) + "," +
                     answer.localizer + "," + status + "," + std::string(answer.reason) + "," +
                     (answer.applied ? "1" : "0");
  const std::optional<Vector6d>& innovation = answer.innovation;
  append(line, ",%.4f", innovation ? innovation->tail<3>().norm() : kNaN);
  append(line, ",%.4f", innovation ? innovation->head<3>().norm() / kRadPerDeg : kNaN);
  line += "," + std::to_string(answer.places);
  answers_ << line << '\n';
}

void RunFolder::finish(RunSummary summary) {
  summary.frames = counted_.frames;
  summary.answers_received = counted_.answers_received;
  summary.answers_applied = counted_.answers_applied;
  summary.answers_rejected = counted_.answers_rejected;
  RunTimes times;
  if (first_frame_) {
    times.duration_s = to_seconds(last_frame_ - *first_frame_);
    if (first_pose_) times.first_pose_s = to_seconds(*first_pose_ - *first_frame_);
    if (first_answer_) times.first_answer_s = to_seconds(*first_answer_ - *first_frame_);
    if (first_localization_) {
      times.first_localization_s = to_seconds(*first_localization_ - *first_frame_);
    }
  }
  if (frames_since_first_pose_ > 0) {
    times.coverage =
        static_cast<double>(covered_frames_) / static_cast<double>(frames_since_first_pose_);
  }
  std::ofstream json = opened(folder_ / kSummary);
  json << to_json(summary, times).dump(2) << '\n';
  json.close();
  if (!json) throw std::runtime_error((folder_ / kSummary).string() + ": cannot be written");
  flush();
}

}  // namespace fleetloc
