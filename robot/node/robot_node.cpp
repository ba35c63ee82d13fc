#include "robot/node/robot_node.hpp"

#include <chrono>
#include <utility>

#include <spdlog/spdlog.h>

#include "robot/dataset/dataset_reader.hpp"
#include "robot/node/dataset_player.hpp"
#include "robot/node/event_log.hpp"
#include "robot/node/pose_sink.hpp"
#include "robot/node/threaded_back_end.hpp"
#include "robot/run_folder/run_recorder.hpp"
#include "robot/runtime/robot_runtime.hpp"
#include "shared/core/cpu_time.hpp"
#include "shared/transport/dds_channel.hpp"

namespace fleetloc {
namespace {

DdsChannel::Config channel_config(const RobotNodeOptions& options) {
  load_qos_profiles(options.qos);
  return {.domain = options.domain,
          .participant_profile = "robot",
          .role = ChannelRole::kRobot,
          .name = options.id,
          .link = options.link};
}

// The time of day orders the runs of a robot's program: the recording's stamps do not. Session
// numbers only tell runs apart, so that they may wrap.
RobotSetup setup(const RobotNodeOptions& options, const DatasetReader& reader) {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  const auto milliseconds = std::chrono::duration_cast<std::chrono::milliseconds>(now).count();
  return {.id = options.id,
          .calibration = reader.calibration(),
          .imu_noise = reader.imu_noise(),
          .session = SessionNumber{static_cast<std::uint32_t>(milliseconds)},
          .program_start = Timestamp{now},
          .T_map_body = options.T_map_body};
}

}  // namespace

struct RobotNode::Parts {
  Parts(const RobotNodeOptions& options,
        const RobotNodeConfig& config,
        std::unique_ptr<DatasetReader> recording)
      : id(options.id),
        channel(channel_config(options)),
        client(options.id, channel, config.client),
        back_end(KeyframeWorker(rectified(recording->calibration()),
                                recording->imu_noise(),
                                config.worker,
                                thread_cpu_time)),
        robot(setup(options, *recording), config.pipeline, back_end, &client, thread_cpu_time),
        recorder(options.out),
        poses(options.domain, options.id),
        events(options.id, channel, client),
        sensors(std::move(recording), options.rate),
        runtime(options.id, sensors, robot, {recorder, poses, events}) {
    recorder.write_config(options.config);
  }

  RobotId id;
  DdsChannel channel;
  CloudClient client;
  ThreadedBackEnd back_end;
  RobotPipeline robot;
  RunRecorder recorder;
  PoseSink poses;
  EventLog events;
  DatasetPlayer sensors;  // starts to play
  RobotRuntime runtime;
};

RobotNode::RobotNode(const RobotNodeOptions& options, const RobotNodeConfig& config)
    : parts_(std::make_unique<Parts>(
          options,
          config,
          std::make_unique<DatasetReader>(DatasetReader::Options{.folder = options.dataset,
                                                                 .start_s = options.start_s,
                                                                 .duration_s = options.duration_s,
                                                                 .tracks = options.tracks}))) {}

RobotNode::~RobotNode() = default;

void RobotNode::run(const std::stop_token& stop) {
  spdlog::info("{}: playing {} frames", parts_->id, parts_->sensors.frame_count().value_or(0));
  parts_->runtime.run(stop);
}

}  // namespace fleetloc
