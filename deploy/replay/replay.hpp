#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>

#include "cloud/pool/localizer_pool.hpp"
#include "deploy/faults/fault_injector.hpp"
#include "deploy/replay/icp_localizer.hpp"
#include "deploy/replay/localizer_plan.hpp"
#include "robot/cloud_client/cloud_client.hpp"
#include "robot/pipeline/robot_pipeline.hpp"
#include "shared/link/link_config.hpp"

namespace fleetloc {

/// Computing times that a replay assumes, so that its latency does not depend on the machine.
struct ReplayDurations {
  double back_end_s;
  double localization_s;
};

struct ReplayConfig {
  RobotPipeline::Config pipeline;
  KeyframeWorker::Config worker;
  CloudClient::Config client;
  LocalizerPool::Config pool;
  IcpLocalizer::Config icp;
  ReplayDurations durations;
};

struct ReplayOptions {
  std::filesystem::path dataset;
  std::filesystem::path out;
  bool tracks = false;                       ///< plays the dataset's tracks instead of its images
  std::optional<std::filesystem::path> map;  ///< without: odometry only
  std::optional<Pose> T_map_body;            ///< start pose, at the first image
  std::optional<StartRegion> region;         ///< at the first image; not beside a pose
  double start_s = 0.0;
  std::optional<double> duration_s;
  LinkConfig link;
  FaultPlan faults;
  LocalizerPlan localizers = one_localizer("localizer");
  bool align_once = false;
  std::optional<std::filesystem::path> samples;  ///< what the robot sends and gets: SampleRecorder
  bool icp_baseline = false;                     ///< in place of the cloud, and without the link
  std::string config;  ///< effective configuration, as YAML; for the run folder
};

/// Opens dataset, map and run folder; throws std::runtime_error for what cannot be opened.
/// @return a function that plays the dataset through robot, link and cloud, once, in one thread and
/// in simulated time: the same input gives the same bits. It throws std::runtime_error, e.g. from
/// the reader.
std::function<void(const std::stop_token&)> prepared_replay(const ReplayOptions& options,
                                                            const ReplayConfig& config);

}  // namespace fleetloc
