#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "shared/wire/status_codec.hpp"
#include "test/pipeline/simulated_system.hpp"

namespace fleetloc {

/// A channel that can be cut: then nothing passes, and nothing is kept.
class SeverableChannel final : public Channel {
 public:
  explicit SeverableChannel(std::unique_ptr<Channel> whole) : whole_(std::move(whole)) {}

  void send(const std::string& partition, Message message, Timestamp now) override {
    if (!is_cut) whole_->send(partition, std::move(message), now);
  }
  [[nodiscard]] std::vector<Message> receive(Timestamp now) override {
    auto messages = whole_->receive(now);
    if (is_cut) messages.clear();
    return messages;
  }
  [[nodiscard]] ChannelStatistics statistics() const override { return whole_->statistics(); }

  bool is_cut = false;

 private:
  std::unique_ptr<Channel> whole_;
};

/// A robot in simulated time, and localizers that come, go and hang.
class InterruptibleSystem {
 public:
  InterruptibleSystem(const SimulatedRun& run, const Pose& T_map_body_start)
      : run_(run),
        robot_end_(network_.join_robot("robot")),
        client_("robot", robot_end_, read_cloud_client_config(defaults().section("client"))),
        back_end_(
            KeyframeWorker(run.stereo(), run.noise(), read_keyframe_worker_config(defaults()), {}),
            std::chrono::milliseconds(50)),
        pipeline_({.id = "robot",
                   .calibration = ideal_cameras(run.stereo()),
                   .imu_noise = run.noise(),
                   .T_map_body = T_map_body_start},
                  read_robot_pipeline_config(defaults()),
                  back_end_,
                  &client_) {}

  /// @param config  YAML that differs from the defaults
  void start(const std::string& name,
             std::uint32_t epoch,
             std::shared_ptr<const LaserMap> map,
             const std::string& config = "{}") {
    ConfigReader reader = defaults();
    reader.overlay(ConfigReader::from_string(config));
    stop(name);
    Localizer& localizer = localizers_[name];
    localizer.epoch = Epoch{epoch};
    localizer.map = map;
    localizer.end = network_.join_cloud(name);
    localizer.cloud = std::make_unique<SimulatedCloud>(
        LocalizerPool(name, localizer.epoch, std::move(map), read_localizer_pool_config(reader)),
        *localizer.end,
        std::chrono::milliseconds(50),
        nullptr);
  }
  /// As kill -9.
  void stop(const std::string& name) { localizers_.erase(name); }
  /// From now on it only says that it accepts robots.
  void hang(const std::string& name) { localizers_.at(name).hangs = true; }
  void cut(bool is_cut) { robot_end_.is_cut = is_cut; }

  /// Plays everything up to `seconds`.
  void play(double seconds) {
    const auto end = Timestamp{from_seconds(seconds)};
    for (const ImuSample& sample : run_.imu(played_, end)) {
      const PoseEstimate pose = pipeline_.add_imu(sample).value();
      client_.set_quality(pose.quality);
      for (auto& [name, localizer] : localizers_) advance(name, localizer, sample.stamp);
      pipeline_.poll(sample.stamp);
      while (run_.frame_stamp(next_frame_) <= sample.stamp) {
        pipeline_.add_tracks(run_.frame(next_frame_++));
      }
      for (FrameOutput& frame : pipeline_.take_frames()) frames.push_back(std::move(frame));
      for (AnswerOutput& answer : pipeline_.take_answers()) answers.push_back(std::move(answer));
      for (std::string& event : client_.take_events()) events.push_back(std::move(event));
    }
    played_ = end + Duration(1);
  }

  [[nodiscard]] const CloudClient& client() const { return client_; }
  [[nodiscard]] const LocalizerPool& pool(const std::string& name) const {
    return localizers_.at(name).cloud->pool();
  }

  std::vector<FrameOutput> frames;
  std::vector<AnswerOutput> answers;
  std::vector<std::string> events;

 private:
  struct Localizer {
    Epoch epoch{};
    std::shared_ptr<const LaserMap> map;
    std::unique_ptr<Channel> end;
    std::unique_ptr<SimulatedCloud> cloud;
    bool hangs = false;
    Timestamp next_status;
  };

  static void advance(const std::string& name, Localizer& localizer, Timestamp now) {
    if (!localizer.hangs) return localizer.cloud->advance(now);
    static_cast<void>(localizer.end->receive(now));
    if (now < localizer.next_status) return;
    localizer.next_status = now + std::chrono::seconds(1);
    const LocalizerStatus status{.localizer = name,
                                 .epoch = localizer.epoch,
                                 .map_hash = localizer.map->info().hash,
                                 .accepting = true};
    localizer.end->send("", {Topic::kLocalizerStatus, encode(status)}, now);
  }

  const SimulatedRun& run_;
  MemoryNetwork network_{perfect_link()};
  SeverableChannel robot_end_;
  std::map<std::string, Localizer> localizers_;
  CloudClient client_;
  SimulatedBackEnd back_end_;
  RobotPipeline pipeline_;
  Timestamp played_;
  int next_frame_ = 0;
};

}  // namespace fleetloc
