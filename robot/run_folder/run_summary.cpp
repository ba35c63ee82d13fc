#include "robot/run_folder/run_summary.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

namespace fleetloc {
namespace {

using nlohmann::json;

json optional(const std::optional<double>& value) {
  return value ? json(*value) : json(nullptr);
}

json percentiles(const Histogram& values) {
  return {{"p50", optional(values.percentile(0.5))}, {"p99", optional(values.percentile(0.99))}};
}

}  // namespace

json to_json(const RunSummary& summary, const RunTimes& times) {
  const double cpu_ms = summary.tracking_ms.sum() + summary.backend_ms.sum();
  const auto frames = static_cast<double>(std::max<std::uint64_t>(summary.frames, 1));
  return {{"frames", summary.frames},
          {"keyframes", summary.keyframes},
          {"submaps_sent", summary.submaps_sent},
          {"answers_received", summary.answers_received},
          {"answers_applied", summary.answers_applied},
          {"answers_rejected", summary.answers_rejected},
          {"corrections_applied", summary.corrections_applied},
          {"corrections_ignored", summary.corrections_ignored},
          {"uplink_bytes", summary.uplink_bytes},
          {"downlink_bytes", summary.downlink_bytes},
          {"uplink_wire_bytes", summary.uplink_wire_bytes},
          {"downlink_wire_bytes", summary.downlink_wire_bytes},
          {"interrupted", summary.interrupted},
          {"duration_s", times.duration_s},
          {"wall_s", summary.wall_s},
          {"cpu_s", summary.cpu_s},
          {"cpu_ms_per_frame", cpu_ms / frames},
          {"decode_ms", percentiles(summary.decode_ms)},
          {"tracking_ms", percentiles(summary.tracking_ms)},
          {"backend_ms", percentiles(summary.backend_ms)},
          {"fusion_us_per_imu", summary.fusion_us_per_imu},
          {"first_pose_s", optional(times.first_pose_s)},
          {"first_answer_s", optional(times.first_answer_s)},
          {"first_localization_s", optional(times.first_localization_s)},
          {"coverage", optional(times.coverage)},
          {"resets", summary.resets},
          {"standstill_s", summary.standstill_s},
          {"input_faults", summary.input_faults},
          {"max_rss_bytes", summary.max_rss_bytes}};
}

}  // namespace fleetloc
