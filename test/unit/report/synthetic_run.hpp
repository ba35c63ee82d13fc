#pragma once

#include <cmath>
#include <filesystem>
#include <string>

#include "robot/run_folder/run_folder.hpp"
#include "shared/geometry/so3.hpp"
#include "shared/trajectory/trajectory.hpp"

namespace fleetloc {

inline constexpr int kFrames = 600;          // at 20 Hz
inline constexpr int kFirstLocalized = 60;   // frame
inline constexpr double kMapError_m = 0.02;  // of every pose in the map
inline constexpr double kDrift_m = 0.001;    // of the odometry, per frame

inline Timestamp frame_stamp(int frame) {
  return Timestamp(std::chrono::milliseconds(1'000'000 + 50 * frame));
}

inline Pose true_pose(int frame) {
  const double t = 0.02 * frame;
  return {.R = exp_so3({0.05, 0.0, t}), .p = {4.0 * std::cos(t), 3.0 * std::sin(t), 1.0}};
}

inline Trajectory true_trajectory() {
  Trajectory trajectory;
  for (int i = 0; i < kFrames; ++i) trajectory.push_back({frame_stamp(i), true_pose(i)});
  return trajectory;
}

/// The odometry drifts along x.
inline Pose odometry_pose(int frame) {
  Pose T_odom_body = inverse(true_pose(0)) * true_pose(frame);
  T_odom_body.p.x() += kDrift_m * frame;
  return T_odom_body;
}

inline PoseEstimate estimate(int frame, bool with_map) {
  PoseEstimate pose;
  pose.stamp = frame_stamp(frame);
  pose.T_odom_body = odometry_pose(frame);
  pose.covariance_odom = 1e-4 * Matrix6d::Identity();
  pose.quality = frame < 10 ? Quality::kInitializing : Quality::kLost;
  if (!with_map || frame < kFirstLocalized) return pose;
  pose.T_map_body = true_pose(frame);
  pose.T_map_body->p.y() += kMapError_m;
  pose.covariance_map = 1e-4 * Matrix6d::Identity();
  pose.quality = frame % 200 > 150 ? Quality::kDeadReckoning : Quality::kLocalized;
  return pose;
}

/// A run of 30 s. Without answers: there was no localizer.
inline void write_run(const std::filesystem::path& folder, bool with_answers) {
  RunFolder run(folder);
  for (int i = 0; i < kFrames; ++i) {
    FrameRecord frame{.pose = estimate(i, with_answers), .round_trip = std::nullopt};
    if (with_answers) {
      frame.uplink_bytes = 1000U * static_cast<unsigned>(i);
      frame.downlink_bytes = 100U * static_cast<unsigned>(i);
      frame.loss = 0.2;
      if (i >= kFirstLocalized) frame.round_trip = std::chrono::milliseconds(600);
    }
    run.add_frame(frame);
    if (!with_answers || i < kFirstLocalized || i % 20 != 0) continue;
    run.add_answer({.stamp = frame_stamp(i - 12),
                    .arrival = frame_stamp(i),
                    .localizer = "localizer_1",
                    .status = LocalizationStatus::kLocalized,
                    .reason = i % 100 == 0 ? "gated" : "",
                    .applied = i % 100 != 0,
                    .innovation = std::nullopt});
  }
  RunSummary summary;
  summary.submaps_sent = 4711;
  summary.uplink_bytes = 599'000;
  for (const double ms : {1.0, 2.0, 3.25}) summary.tracking_ms.add(ms);
  summary.input_faults = {{"imu_gaps", 2}};
  run.finish(summary);
}

}  // namespace fleetloc
