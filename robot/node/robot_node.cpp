#include "robot/node/robot_node.hpp"

#include <chrono>
#include <utility>

#include <spdlog/spdlog.h>

#include "robot/node/dataset_player.hpp"
#include "robot/node/threaded_back_end.hpp"
#include "robot/pipeline/run_recorder.hpp"
#include "shared/config/progress_line.hpp"
#include "shared/core/cpu_time.hpp"
#include "shared/transport/dds_channel.hpp"
#include "shared/transport/pose_publisher.hpp"
#include "shared/wire/pose_codec.hpp"

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

RobotSetup setup(const RobotNodeOptions& options, const DatasetReader& reader) {
  return {.id = options.id,
          .calibration = reader.calibration(),
          .imu_noise = reader.imu_noise(),
          .T_map_body = options.T_map_body};
}

}  // namespace

struct RobotNode::Parts {
  Parts(const RobotNodeOptions& options, const RobotNodeConfig& config, DatasetReader reader)
      : id(options.id),
        channel(channel_config(options)),
        publisher(options.domain, options.id),
        client(options.id, channel, config.client),
        back_end(KeyframeWorker(
            rectified(reader.calibration()), reader.imu_noise(), config.worker, thread_cpu_time)),
        pipeline(setup(options, reader), config.pipeline, back_end, &client, thread_cpu_time),
        recorder(options.out),
        frame_count(reader.frame_count()),
        player(std::move(reader), options.rate) {}

  void take(DatasetPlayer::Played played);

  RobotId id;
  DdsChannel channel;
  PosePublisher publisher;
  CloudClient client;
  ThreadedBackEnd back_end;
  RobotPipeline pipeline;
  RunRecorder recorder;
  std::size_t frame_count;
  std::size_t frames = 0;
  DatasetPlayer player;  // last: it starts to play
};

RobotNode::RobotNode(const RobotNodeOptions& options, const RobotNodeConfig& config)
    : parts_(std::make_unique<Parts>(options,
                                     config,
                                     DatasetReader({.folder = options.dataset,
                                                    .start_s = options.start_s,
                                                    .duration_s = options.duration_s}))) {}

RobotNode::~RobotNode() = default;

void RobotNode::Parts::take(DatasetPlayer::Played played) {
  if (auto* frame = std::get_if<StereoFrame>(&played.item)) {
    recorder.add_decoding(played.decoding_cpu);
    pipeline.add_images(std::move(*frame));
    ++frames;
    return;
  }
  const auto& sample = std::get<ImuSample>(played.item);
  const PoseEstimate pose = pipeline.add_imu(sample);
  pipeline.poll(sample.stamp);
  recorder.add_imu_rate_pose(pose);
  recorder.take(pipeline, client.traffic());
  if (pose.quality != Quality::kInitializing)
    publisher.publish(encode(RobotPoseEstimate{id, pose}));
}

void RobotNode::run(const std::stop_token& stop) {
  Parts& parts = *parts_;
  const auto begin = std::chrono::steady_clock::now();
  spdlog::info("{}: playing {} frames", parts.id, parts.frame_count);
  {
    ProgressLine progress(parts.id);
    while (auto played = parts.player.next(stop)) {
      parts.take(std::move(*played));
      progress.show(parts.frames, parts.frame_count);
    }
  }
  parts.recorder.take(parts.pipeline, parts.client.traffic());
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
  parts.recorder.finish(
      parts.pipeline, parts.client.traffic(), wall.count(), parts.player.reader().faults());
  spdlog::info("{}: {} frames, {} keyframes, {} submaps sent, {} answers from {}",
               parts.id,
               parts.frames,
               parts.pipeline.keyframes(),
               parts.client.statistics().submaps_sent,
               parts.client.statistics().answers_received,
               parts.client.statistics().localizer.empty() ? "no localizer"
                                                           : parts.client.statistics().localizer);
}

}  // namespace fleetloc
