#pragma once

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cloud/laser_map/build_map.hpp"
#include "cloud/pool/localizer_pool.hpp"
#include "cloud/pool/worker_load.hpp"
#include "robot/cloud_client/cloud_client.hpp"
#include "shared/link/memory_network.hpp"
#include "test/simulated_setup.hpp"

namespace fleetloc {

/// Many robots and several localizers with their real protocols in simulated time. Keyframes hold
/// one observation, and a localization takes its time, on one worker, but finds whatever is asked
/// for.
class SimulatedFleet {
 public:
  explicit SimulatedFleet(const LinkConfig& link = perfect_link(),
                          Duration localization = std::chrono::milliseconds(10))
      : localization_(localization), network_(link) {}

  void start(const std::string& name) {
    kill(name);
    Localizer& localizer = localizers_[name];
    localizer.end = network_.join_cloud(name);
    localizer.pool = std::make_unique<LocalizerPool>(
        name, Incarnation{++incarnations_}, map_, read_localizer_pool_config(defaults()));
    localizer.load = std::make_unique<WorkerLoad>(1, now_);
  }
  void kill(const std::string& name) { localizers_.erase(name); }
  /// As by SIGTERM.
  void stop(const std::string& name) {
    localizers_.at(name).pool->drain(now_);
    localizers_.at(name).draining_since = now_;
  }

  /// It sends a keyframe each half second from now on.
  void add_robot(const RobotId& id) {
    Robot& robot = robots_[id];
    robot.end = network_.join_robot(id);
    robot.client = std::make_unique<CloudClient>(
        id, *robot.end, read_cloud_client_config(defaults().section("client")));
    RobotSession session;
    session.robot = id;
    session.session = SessionNumber{1};
    session.start_stamp = now_;
    session.stereo = {
        .focal_px = 450.0, .center_px = {1024.0, 1024.0}, .baseline_m = 0.1, .T_body_cam0 = {}};
    session.start = MapOdomEstimate{};
    robot.client->start_session(session, now_);
    robot.next_keyframe_at = now_ + kKeyframe * static_cast<int>(robots_.size() % 10) / 10;
  }

  void play(double seconds) {
    const Timestamp end = now_ + from_seconds(seconds);
    while (now_ < end) {
      now_ += std::chrono::milliseconds(10);
      for (auto it = localizers_.begin(); it != localizers_.end();) {
        advance(it->second);
        it = is_over(it->second) ? localizers_.erase(it) : std::next(it);
      }
      for (auto& [id, robot] : robots_) advance(robot);
    }
  }

  [[nodiscard]] int sessions(const std::string& name) const {
    return static_cast<int>(localizers_.at(name).pool->sessions());
  }
  [[nodiscard]] bool runs(const std::string& name) const { return localizers_.contains(name); }
  [[nodiscard]] CloudClient::Statistics statistics(const RobotId& id) const {
    return robots_.at(id).client->statistics();
  }
  /// From now on times without answers are counted anew.
  void count_anew() {
    for (auto& [id, robot] : robots_) {
      robot.longest_s = 0.0;
      robot.answered = now_;
    }
  }
  /// The longest time that each robot has been without a new answer [s], shortest first.
  [[nodiscard]] std::vector<double> without_answer() const {
    std::vector<double> longest_s;
    for (const auto& [id, robot] : robots_) {
      longest_s.push_back(std::max(robot.longest_s, to_seconds(now_ - robot.answered)));
    }
    std::ranges::sort(longest_s);
    return longest_s;
  }

 private:
  struct Localizer {
    std::unique_ptr<Channel> end;
    std::unique_ptr<LocalizerPool> pool;
    std::unique_ptr<WorkerLoad> load;
    std::optional<std::pair<LocalizerPool::Job, Timestamp>> running;  // until then
    std::optional<Timestamp> draining_since;
  };
  struct Robot {
    std::unique_ptr<Channel> end;
    std::unique_ptr<CloudClient> client;  // uses the end
    std::uint32_t keyframes = 0;
    Timestamp next_keyframe_at;
    Timestamp answered;
    double longest_s = 0.0;
  };
  static constexpr Duration kKeyframe = std::chrono::milliseconds(500);

  [[nodiscard]] bool is_over(const Localizer& localizer) const {
    return localizer.draining_since &&
           now_ - *localizer.draining_since > std::chrono::milliseconds(300) &&
           localizer.pool->to_leave(now_).empty();
  }

  void advance(Localizer& localizer) {
    for (const Message& message : localizer.end->receive(now_)) {
      localizer.pool->receive(message, now_);
    }
    if (localizer.running && localizer.running->second <= now_) {
      localizer.load->add(localization_);
      const LocalizerPool::Job job = std::move(localizer.running->first);
      localizer.running.reset();
      localizer.pool->finish(job, answer_to(job), 1.0, now_);
    }
    if (!localizer.running) {
      if (auto job = localizer.pool->take_job(now_)) {
        localizer.running.emplace(std::move(*job), now_ + localization_);
      }
    }
    for (auto& outgoing : localizer.pool->outgoing(now_, localizer.load->measure(now_))) {
      localizer.end->send(outgoing.partition, std::move(outgoing.message), now_);
    }
  }

  static LocalizationResult answer_to(const LocalizerPool::Job& job) {
    const auto newest = [](const Submap& submap) { return submap.keyframes.back().id; };
    const SubmapKeyframe& keyframe =
        std::ranges::max_element(job.submaps, {}, newest)->keyframes.back();
    LocalizationResult answer;
    answer.status = LocalizationStatus::kLocalized;
    answer.keyframe = keyframe.id;
    answer.revision = keyframe.revision;
    answer.stamp = keyframe.stamp;
    answer.oldest_stamp = keyframe.stamp;
    answer.covariance = 1e-4 * Matrix6d::Identity();
    return answer;
  }

  void advance(Robot& robot) {
    if (robot.answered == Timestamp{}) robot.answered = now_;
    if (now_ >= robot.next_keyframe_at) {
      robot.next_keyframe_at += kKeyframe;
      Submap submap;
      submap.keyframes.push_back({.id = KeyframeId{++robot.keyframes},
                                  .revision = Revision{1},
                                  .stamp = now_,
                                  .T_odom_body = {},
                                  .tilt_sigma = 0.01,
                                  .observations = {{.landmark = LandmarkId{robot.keyframes},
                                                    .left = {1000.0, 1000.0},
                                                    .disparity = 5.0}}});
      robot.client->submit(std::move(submap), now_);
    }
    if (robot.client->take_answers(now_).empty()) return;
    robot.longest_s = std::max(robot.longest_s, to_seconds(now_ - robot.answered));
    robot.answered = now_;
  }

  Duration localization_;
  Timestamp now_;
  std::uint32_t incarnations_ = 0;
  std::shared_ptr<const LaserMap> map_ =
      std::make_shared<const LaserMap>(build_map({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}},
                                                 "map",
                                                 read_map_config(defaults().section("map"))));
  MemoryNetwork network_;
  std::map<std::string, Localizer> localizers_;
  std::map<RobotId, Robot> robots_;  // last: they use their ends of the network
};

}  // namespace fleetloc
