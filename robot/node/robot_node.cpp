#include "robot/node/robot_node.hpp"

#include <chrono>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include <spdlog/spdlog.h>

#include "robot/dataset/dataset_reader.hpp"
#include "robot/node/calibration_topics.hpp"
#include "robot/node/dataset_player.hpp"
#include "robot/node/event_log.hpp"
#include "robot/node/live_sensors.hpp"
#include "robot/node/pose_sink.hpp"
#include "robot/node/reload_sink.hpp"
#include "robot/node/ros2_diagnostics.hpp"
#include "robot/node/ros2_output.hpp"
#include "robot/node/service_sink.hpp"
#include "robot/node/threaded_back_end.hpp"
#include "robot/run_folder/run_recorder.hpp"
#include "robot/runtime/robot_runtime.hpp"
#include "shared/core/boot_time.hpp"
#include "shared/core/cpu_time.hpp"
#include "shared/transport/dds_channel.hpp"
#include "shared/transport/ros2/ros2_profiles.hpp"

namespace fleetloc {
namespace {

DdsChannel::Config channel_config(const RobotNodeOptions& options) {
  return {.domain = options.domain,
          .participant_profile = "robot",
          .role = ChannelRole::kRobot,
          .name = options.id,
          .link = options.link,
          .keys = options.keys};
}

// The time of day orders the runs of a robot's program: the sensors' stamps need not. Session
// numbers only tell runs apart, so that they may wrap.
RobotSetup setup(const RobotNodeOptions& options, const SensorRig& rig) {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  const auto milliseconds = std::chrono::duration_cast<std::chrono::milliseconds>(now).count();
  return {.id = options.id,
          .calibration = rig.cameras,
          .imu_noise = rig.imu_noise,
          .session = SessionNumber{static_cast<std::uint32_t>(milliseconds)},
          .program_start = Timestamp{now},
          .T_map_body = options.T_map_body,
          .region = options.region};
}

std::function<void(const std::string&)> logger_of(const RobotId& robot) {
  return [robot](const std::string& event) { spdlog::info("{}: {}", robot, event); };
}

SensorsConfig read_sensors(const std::filesystem::path& file) {
  SensorsConfig config = read_sensors_config(file);
  load_ros2_profiles(config.qos);
  return config;
}

}  // namespace

struct RobotNode::Live {
  explicit Live(const std::filesystem::path& file)
      : config(read_sensors(file)), participant(static_cast<std::uint32_t>(config.domain)) {}

  SensorsConfig config;
  Ros2Participant participant;
};

struct RobotNode::Parts {
  /// @param live  null: a recording is played
  Parts(const RobotNodeOptions& options,
        const RobotNodeConfig& config,
        const SensorRig& rig,
        ServiceManager& service_manager,
        ReloadRequest& reload,
        Live* live = nullptr)
      : id(options.id),
        channel(channel_config(options)),
        client(options.id, channel, config.client),
        back_end(
            KeyframeWorker(rectified(rig.cameras), rig.imu_noise, config.worker, thread_cpu_time)),
        robot(setup(options, rig), config.pipeline, back_end, &client, thread_cpu_time),
        poses(options.domain, options.id),
        events(options.id, channel, client),
        service(service_manager) {
    if (!options.out.empty()) {
      recorder.emplace(options.out, config.recording);
      recorder->write_config(options.config);
    }
    reloading.emplace(options.id, reload, recorder ? &*recorder : nullptr);
    if (live != nullptr) output.emplace(live->config, live->participant);
    if (!options.last_pose.empty()) last_pose.emplace(options.last_pose, options.id);
  }

  /// @param source  which plays, or listens, from its construction on: it comes last
  void start(std::unique_ptr<SensorSource> source) {
    sensors = std::move(source);
    std::vector<std::reference_wrapper<RobotSink>> sinks{poses, events, service, *reloading};
    if (recorder) sinks.emplace_back(*recorder);
    if (output) sinks.emplace_back(*output);
    if (diagnostics) sinks.emplace_back(*diagnostics);
    if (last_pose) sinks.emplace_back(*last_pose);
    runtime.emplace(id, *sensors, robot, sinks);
  }

  RobotId id;
  DdsChannel channel;
  CloudClient client;
  ThreadedBackEnd back_end;
  RobotPipeline robot;
  std::optional<RunRecorder> recorder;
  PoseSink poses;
  EventLog events;
  ServiceSink service;
  std::optional<ReloadSink> reloading;
  std::optional<Ros2Output> output;
  std::optional<LastPoseFile> last_pose;
  std::unique_ptr<SensorSource> sensors;
  std::optional<Ros2Diagnostics> diagnostics;  // asks the sensors
  std::optional<RobotRuntime> runtime;
};

RobotNode::RobotNode(const RobotNodeOptions& options,
                     const RobotNodeConfig& config,
                     ReloadRequest& reload)
    : options_(options), config_(config), reload_(reload) {
  load_qos_profiles(options.qos);
  start_from_last_pose();
  if (options.sensors.empty()) {
    begin_recording();
  } else {
    live_ = std::make_unique<Live>(options.sensors);
    if (const auto rig = read_sensor_rig(live_->config.calibration)) begin_live(*rig);
  }
}

RobotNode::~RobotNode() = default;

// Unless somebody has told where the robot is.
void RobotNode::start_from_last_pose() {
  if (options_.last_pose.empty() || options_.T_map_body) return;
  if (options_.region) {
    spdlog::info("{}: starts in the region that was told, not from {}",
                 options_.id,
                 options_.last_pose.string());
    return;
  }
  options_.T_map_body = read_last_pose(options_.last_pose, options_.id);
  if (!options_.T_map_body) return;
  spdlog::info("{}: starts from its last pose, in {}", options_.id, options_.last_pose.string());
  config_.pipeline.start.position_sigma_m = config_.last_pose.position_sigma_m;
  config_.pipeline.start.yaw_sigma_rad = config_.last_pose.yaw_sigma_rad;
}

void RobotNode::begin_recording() {
  auto recording =
      std::make_unique<DatasetReader>(DatasetReader::Options{.folder = options_.dataset,
                                                             .start_s = options_.start_s,
                                                             .duration_s = options_.duration_s,
                                                             .tracks = options_.tracks});
  const SensorRig rig{.cameras = recording->calibration(), .imu_noise = recording->imu_noise()};
  parts_ = std::make_unique<Parts>(options_, config_, rig, service_, reload_);
  spdlog::info("{}: playing {} frames", options_.id, recording->frame_count().value_or(0));
  parts_->start(std::make_unique<DatasetPlayer>(std::move(recording), options_.rate));
}

void RobotNode::begin_live(const SensorRig& rig) {
  const SensorsConfig& sensors = live_->config;
  spdlog::info("{}: live from {}, {} and {}, DDS domain {}",
               options_.id,
               sensors.left.topic.name,
               sensors.right.topic.name,
               sensors.imu.name,
               sensors.domain);
  parts_ = std::make_unique<Parts>(options_, config_, rig, service_, reload_, live_.get());
  auto source = std::make_unique<LiveSensors>(
      sensors, rig, live_->participant, logger_of(options_.id), [this] {
        service_.alive(boot_time());
      });
  if (sensors.output.diagnostics) {
    parts_->diagnostics.emplace(options_.id, live_->participant, [&live = *source] {
      return SensorState{.silent_topics = live.silent_topics(), .faults = live.faults()};
    });
  }
  parts_->start(std::move(source));
}

void RobotNode::run(const std::stop_token& stop) {
  const std::stop_callback stopping(stop, [this] { service_.stopping(); });
  service_.ready();
  if (!parts_) {
    const auto rig = calibration_from_topics(
        live_->config, live_->participant, logger_of(options_.id), stop, [this] {
          service_.alive(boot_time());
        });
    if (!rig) return;
    begin_live(*rig);
  }
  parts_->runtime->run(stop);
}

}  // namespace fleetloc
