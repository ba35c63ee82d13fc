#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "robot/calibration/sensor_rig.hpp"
#include "robot/cloud_client/cloud_client.hpp"
#include "robot/node/last_pose.hpp"
#include "robot/pipeline/robot_pipeline.hpp"
#include "robot/run_folder/run_folder.hpp"
#include "shared/concurrency/reload_request.hpp"
#include "shared/link/link_config.hpp"
#include "shared/service/service_manager.hpp"
#include "shared/transport/fleet_keys.hpp"

namespace fleetloc {

struct RobotNodeOptions {
  RobotId id;
  std::filesystem::path dataset;  ///< a recording to play; or
  std::filesystem::path sensors;  ///< what describes live sensors, see SensorsConfig
  bool tracks = false;            ///< plays its tracks instead of its images
  std::filesystem::path qos;
  std::filesystem::path out;  ///< run folder; empty: nothing is written
  std::uint32_t domain = 0;
  double rate = 1.0;  ///< of the recording's time; 0: as fast as possible
  double start_s = 0.0;
  std::optional<double> duration_s;
  std::optional<Pose> T_map_body;                    ///< at the first image
  std::optional<StartRegion> region = std::nullopt;  ///< at the first image; not beside a pose
  std::filesystem::path last_pose;  ///< keeps the pose for the next start; empty: none does
  std::optional<FleetKeys> keys = std::nullopt;  ///< none: no DDS Security
  std::optional<LinkConfig> link;
  std::string config;  ///< in force, as YAML; for the run folder
};

struct RobotNodeConfig {
  RobotPipeline::Config pipeline;
  KeyframeWorker::Config worker;
  CloudClient::Config client{};
  LastPoseSigma last_pose{};
  RunParts recording{};
};

/// A robot with live sensors, or that plays a recording: everything that can fail before it starts
/// fails in the constructor (TransportError, DatasetError, ConfigError, std::runtime_error), but
/// for what needs a calibration that comes on topics.
class RobotNode {
 public:
  /// @param reload  begins a new part of the run folder; outlives the node
  RobotNode(const RobotNodeOptions& options, const RobotNodeConfig& config, ReloadRequest& reload);
  ~RobotNode();
  RobotNode(const RobotNode&) = delete;
  RobotNode& operator=(const RobotNode&) = delete;

  /// Until the recording ends or a stop is requested; then the run folder is complete. Waits first
  /// for a calibration that comes on topics.
  void run(const std::stop_token& stop);

 private:
  struct Live;
  struct Parts;

  void start_from_last_pose();
  void begin_recording();
  void begin_live(const SensorRig& rig);

  RobotNodeOptions options_;
  RobotNodeConfig config_;
  ReloadRequest& reload_;
  ServiceManager service_;
  std::unique_ptr<Live> live_;    // without a recording; outlives the parts
  std::unique_ptr<Parts> parts_;  // null while the calibration is still to come
};

}  // namespace fleetloc
