#include "robot/run_folder/run_recorder.hpp"

#include <exception>
#include <utility>

#include <spdlog/spdlog.h>
#include <sys/resource.h>

namespace fleetloc {
namespace {

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

}  // namespace

void RunRecorder::add(const RobotOutput& output) {
  try {
    if (unwritten_ == 0) return write(output);
  } catch (const std::exception& error) {
    spdlog::error("the recording ends here: {}", error.what());
  }
  ++unwritten_;
}

std::map<std::string, std::uint64_t> RunRecorder::faults() const {
  if (unwritten_ == 0) return {};
  return {{"unwritten_outputs", unwritten_}};
}

void RunRecorder::write(const RobotOutput& output) {
  if (std::exchange(is_new_part_, false)) folder_.begin_part();
  if (output.pose) folder_.add_imu_rate_pose(*output.pose);
  for (const FrameOutput& frame : output.frames) {
    tracking_ms_.add(1e3 * to_seconds(frame.tracking_cpu));
    folder_.add_frame({.pose = frame.pose,
                       .uplink_bytes = output.traffic.uplink_bytes,
                       .downlink_bytes = output.traffic.downlink_bytes,
                       .loss = output.traffic.loss,
                       .round_trip = output.traffic.round_trip,
                       .tracks = frame.tracks,
                       .keyframe = frame.keyframe,
                       .resets = frame.resets});
  }
  for (const LocalizationOutput& answer : output.answers) {
    folder_.add_answer({.stamp = answer.answer.stamp,
                        .arrival = answer.arrival,
                        .localizer = answer.answer.localizer,
                        .status = answer.answer.status,
                        .reason = name(answer.outcome),
                        .applied = answer.outcome.has_value(),
                        .innovation = answer.innovation,
                        .places = answer.answer.places});
  }
}

void RunRecorder::finish(const RunEnd& end) {
  const OdometryStatistics& odometry = end.robot.odometry().statistics();
  RunSummary summary{.keyframes = odometry.keyframes,
                     .submaps_sent = end.traffic.submaps_sent,
                     .answers_rejected = {},  // follows from the records
                     .corrections_applied = odometry.corrections_applied,
                     .corrections_ignored = odometry.corrections_ignored,
                     .uplink_bytes = end.traffic.uplink_bytes,
                     .downlink_bytes = end.traffic.downlink_bytes,
                     .uplink_wire_bytes = end.traffic.uplink_wire_bytes,
                     .downlink_wire_bytes = end.traffic.downlink_wire_bytes,
                     .resets = odometry.resets,
                     .standstill_s = to_seconds(odometry.standstill),
                     .input_faults = end.faults,
                     .interrupted = end.interrupted,
                     .wall_s = end.wall_s,
                     .decode_ms = end.decode_ms,
                     .tracking_ms = tracking_ms_,
                     .backend_ms = odometry.back_end_ms};
  for (const auto& [kind, count] : end.robot.faults()) summary.input_faults[kind] += count;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  summary.cpu_s = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  summary.max_rss_bytes = static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
  if (end.robot.imu_samples() > 0) {
    summary.fusion_us_per_imu =
        1e6 * to_seconds(end.robot.fusion_cpu()) / static_cast<double>(end.robot.imu_samples());
  }
  folder_.finish(summary);
}

}  // namespace fleetloc
