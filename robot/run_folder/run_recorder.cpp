#include "robot/run_folder/run_recorder.hpp"

#include <sys/resource.h>

namespace fleetloc {
namespace {

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

}  // namespace

void RunRecorder::record(RobotPipeline& pipeline, const CloudClient::Traffic& traffic) {
  for (const FrameOutput& frame : pipeline.take_frames()) {
    if (!frame.refused.empty()) continue;  // has no pose, and an invalid stamp
    summary_.tracking_ms.add(1e3 * to_seconds(frame.tracking_cpu));
    folder_.add_frame({.pose = frame.pose,
                       .uplink_bytes = traffic.uplink_bytes,
                       .downlink_bytes = traffic.downlink_bytes,
                       .loss = traffic.loss,
                       .round_trip = traffic.round_trip,
                       .tracks = frame.tracks,
                       .keyframe = frame.keyframe,
                       .resets = frame.resets});
  }
  for (const LocalizationOutput& output : pipeline.take_answers()) {
    folder_.add_answer({.stamp = output.answer.stamp,
                        .arrival = output.arrival,
                        .localizer = output.answer.localizer,
                        .status = output.answer.status,
                        .reason = output.reason,
                        .applied = output.applied});
  }
}

void RunRecorder::finish(const RobotPipeline& pipeline,
                         const CloudClient::Traffic& traffic,
                         const End& end) {
  summary_.backend_ms = pipeline.back_end_ms();
  summary_.keyframes = pipeline.keyframes();
  summary_.submaps_sent = traffic.submaps_sent;
  summary_.corrections_applied = pipeline.corrections_applied();
  summary_.corrections_ignored = pipeline.corrections_ignored();
  summary_.uplink_bytes = traffic.uplink_bytes;
  summary_.downlink_bytes = traffic.downlink_bytes;
  summary_.uplink_wire_bytes = traffic.uplink_wire_bytes;
  summary_.downlink_wire_bytes = traffic.downlink_wire_bytes;
  summary_.interrupted = end.interrupted;
  summary_.input_faults = end.input_faults;
  for (const auto& [kind, count] : pipeline.faults()) summary_.input_faults[kind] += count;
  summary_.resets = pipeline.resets();
  summary_.wall_s = end.wall_s;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  summary_.cpu_s = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  summary_.max_rss_bytes = static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
  if (pipeline.imu_samples() > 0) {
    summary_.fusion_us_per_imu =
        1e6 * to_seconds(pipeline.fusion_cpu()) / static_cast<double>(pipeline.imu_samples());
  }
  folder_.finish(summary_);
}

}  // namespace fleetloc
