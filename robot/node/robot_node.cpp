#include "robot/node/robot_node.hpp"

#include <chrono>
#include <utility>

#include <spdlog/spdlog.h>

#include "robot/node/dataset_player.hpp"
#include "robot/node/threaded_back_end.hpp"
#include "robot/run_folder/run_recorder.hpp"
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
        player(std::move(reader), options.rate) {
    recorder.write_config(options.config);
  }

  void play(const std::stop_token& stop);
  void take(DatasetPlayer::Played played);
  void publish(const PoseEstimate& pose);
  void finish(double wall_s, bool interrupted);

  RobotId id;
  DdsChannel channel;
  PosePublisher publisher;
  CloudClient client;
  ThreadedBackEnd back_end;
  RobotPipeline pipeline;
  RunRecorder recorder;
  std::size_t frame_count;
  std::size_t frames = 0;
  std::uint64_t unpublished = 0;  // poses
  DatasetPlayer player;           // last: it starts to play
};

RobotNode::RobotNode(const RobotNodeOptions& options, const RobotNodeConfig& config)
    : parts_(std::make_unique<Parts>(options,
                                     config,
                                     DatasetReader({.folder = options.dataset,
                                                    .start_s = options.start_s,
                                                    .duration_s = options.duration_s,
                                                    .tracks = options.tracks}))) {}

RobotNode::~RobotNode() = default;

void RobotNode::Parts::take(DatasetPlayer::Played played) {
  if (auto* frame = std::get_if<CameraFrame>(&played.item)) {
    recorder.add_decoding(played.decoding_cpu);
    pipeline.add_frame(std::move(*frame));
    ++frames;
    return;
  }
  const auto pose = pipeline.add_imu(std::get<ImuSample>(played.item));
  if (!pose) return;  // refused: neither its content nor its stamp can be trusted
  client.set_quality(pose->quality);
  pipeline.poll(pose->stamp);
  for (const std::string& event : channel.take_events()) spdlog::info("{}: {}", id, event);
  for (const std::string& event : client.take_events()) spdlog::info("{}: {}", id, event);
  recorder.add_imu_rate_pose(*pose);
  recorder.record(pipeline, client.traffic());
  if (pose->quality != Quality::kInitializing) publish(*pose);
}

void RobotNode::Parts::publish(const PoseEstimate& pose) {
  try {
    publisher.publish(encode(RobotPoseEstimate{id, pose}));
  } catch (const NotEncodable&) {  // out of range of the wire type
    ++unpublished;
  }
}

void RobotNode::Parts::play(const std::stop_token& stop) {
  ProgressLine progress(id);
  while (auto played = player.next(stop)) {
    take(std::move(*played));
    progress.show(frames, frame_count);
  }
}

// What has been recorded is kept, whatever ended the run.
void RobotNode::Parts::finish(double wall_s, bool interrupted) {
  player.stop();
  recorder.record(pipeline, client.traffic());
  auto faults = player.input().faults();
  if (unpublished > 0) faults["unpublished_poses"] = unpublished;
  recorder.finish(
      pipeline,
      client.traffic(),
      {.interrupted = interrupted, .wall_s = wall_s, .input_faults = std::move(faults)});
  const CloudClient::Statistics statistics = client.statistics();
  spdlog::info("{}: {} frames, {} keyframes, {} submaps sent, {} answers from {}",
               id,
               frames,
               pipeline.keyframes(),
               statistics.submaps_sent,
               statistics.answers_received,
               statistics.localizer.empty() ? "no localizer" : statistics.localizer);
  if (pipeline.resets() > 0) spdlog::warn("{}: {} resets of the odometry", id, pipeline.resets());
  for (const auto& [reason, count] : statistics.refused) {
    spdlog::warn("{}: {} messages not used: {}", id, count, reason);
  }
}

void RobotNode::run(const std::stop_token& stop) {
  const auto begin = std::chrono::steady_clock::now();
  const auto finish = [&] {
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
    parts_->finish(wall.count(), stop.stop_requested());
  };
  spdlog::info("{}: playing {} frames", parts_->id, parts_->frame_count);
  try {
    parts_->play(stop);
  } catch (...) {
    finish();
    throw;
  }
  finish();
}

}  // namespace fleetloc
