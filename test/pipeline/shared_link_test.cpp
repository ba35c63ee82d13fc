// Robots on one narrow radio cell: they know nothing of each other, and share it evenly.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "cloud/pool/localizer_pool.hpp"
#include "robot/cloud_client/cloud_client.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/link/memory_network.hpp"
#include "test/pipeline/simulated_system.hpp"
#include "test/unit/compact/moving_robot.hpp"
#include "test/unit/timestamps.hpp"

namespace fleetloc {
namespace {

constexpr double kDelay = 0.3;             // one way [s]
constexpr double kKeyframeInterval = 0.5;  // of each robot [s]
constexpr std::size_t kLandmarks = 80;     // in each keyframe

/// 250 kbit/s each way, as of one cell of NB-IoT.
LinkConfig cell(double loss) {
  const LinkDirection direction{
      .loss = loss, .delay_s = kDelay, .rate_bytes_per_s = 31'250.0, .queue_bytes = 250'000};
  return {.uplink = direction, .downlink = direction, .seed = 1};
}

Submap long_drive() {
  Submap drive = moving_robot(100, 260);
  for (auto& keyframe : drive.keyframes) {
    if (keyframe.observations.size() > kLandmarks) keyframe.observations.resize(kLandmarks);
  }
  for (VirtualEdge& edge : drive.edges) edge.is_final = true;
  return drive;
}

/// As large as a datagram has room for.
Correction large_correction(KeyframeId anchor) {
  std::mt19937 random(static_cast<std::uint32_t>(anchor));
  std::uniform_real_distribution<double> place(-10.0, 10.0);
  Correction correction{.robot = {},
                        .session = {},
                        .localizer = {},
                        .incarnation = {},
                        .anchor = anchor,
                        .relative_poses = {},
                        .landmarks = {}};
  for (std::uint32_t i = 0; i < 45; ++i) {
    correction.landmarks.push_back({.id = LandmarkId{5000 + 3 * i},
                                    .p_anchor = {place(random), place(random), place(random)},
                                    .information = 1e4 * Eigen::Matrix3d::Identity()});
  }
  return correction;
}

/// The robots' and the cloud's end of the protocol; poses are not computed.
class Cell {
 public:
  struct Robot {
    std::unique_ptr<Channel> channel;
    std::unique_ptr<CloudClient> client;
    bool is_started = false;
    std::size_t next = 1;  // keyframe
    double start_s = 0.0;
    double last_answer_s = 0.0;
    double longest_gap_s = 0.0;    // between answers
    double longest_delay_s = 0.0;  // of the network, without that of an empty one
    std::uint64_t bytes_before = 0;
  };

  Cell(int robots, double loss) : network_(cell(loss), MemoryNetwork::Links::kShared) {
    cloud_ = network_.join_cloud("localizer");
    for (int i = 0; i < robots; ++i) {
      const std::string name = "robot_" + std::to_string(i);
      Robot robot;
      robot.channel = network_.join_robot(name);
      robot.client = std::make_unique<CloudClient>(
          name, *robot.channel, read_cloud_client_config(defaults().section("client")));
      robot.start_s = 0.05 + 0.13 * i;
      robots_.push_back(std::move(robot));
    }
  }

  void run(double from_s, double to_s) {
    for (double s = from_s; s < to_s; s += 0.01) {
      serve(s);
      for (Robot& robot : robots_) drive(robot, s);
    }
  }

  /// What was seen until now counts no more.
  void forget(double s) {
    for (Robot& robot : robots_) {
      robot.bytes_before = robot.channel->statistics().sent_wire_bytes;
      robot.longest_gap_s = robot.longest_delay_s = 0.0;
      robot.last_answer_s = s;
    }
  }

  [[nodiscard]] const std::vector<Robot>& robots() const { return robots_; }

  /// Jain's index of what they have sent.
  [[nodiscard]] double fairness() const {
    double sum = 0.0;
    double squares = 0.0;
    for (const Robot& robot : robots_) {
      const auto bytes =
          static_cast<double>(robot.channel->statistics().sent_wire_bytes - robot.bytes_before);
      sum += bytes;
      squares += bytes * bytes;
    }
    return sum * sum / (static_cast<double>(robots_.size()) * squares);
  }

 private:
  void serve(double s) {
    for (const Message& message : cloud_->receive(at(s))) pool_.receive(message, at(s));
    while (auto job = pool_.take_job(at(s))) {
      const SubmapKeyframe& newest = job->submaps.back().keyframes.back();
      LocalizationResult answer;
      answer.status = LocalizationStatus::kLocalized;
      answer.keyframe = newest.id;
      answer.revision = newest.revision;
      answer.stamp = answer.oldest_stamp = newest.stamp;
      answer.covariance = 1e-4 * Matrix6d::Identity();
      job->correction = large_correction(newest.id);
      pool_.finish(*job, std::move(answer), 1.0, at(s));
    }
    for (const auto& outgoing : pool_.outgoing(at(s), 0.0)) {
      cloud_->send(outgoing.partition, outgoing.message, at(s));
    }
  }

  void drive(Robot& robot, double s) {
    if (s < robot.start_s) return;
    if (!robot.is_started) start(robot, s);
    const double due_s = robot.start_s + kKeyframeInterval * static_cast<double>(robot.next);
    if (s >= due_s && robot.next < drive_.keyframes.size()) {
      robot.client->submit(window_until(robot.next++), at(s));
    }
    for (const auto& answer : robot.client->take_answers(at(s))) {
      if (answer.status != LocalizationStatus::kLocalized) continue;
      robot.last_answer_s = s;
    }
    robot.longest_gap_s = std::max(robot.longest_gap_s, s - robot.last_answer_s);
    if (const auto round_trip = robot.client->statistics().round_trip) {
      robot.longest_delay_s =
          std::max(robot.longest_delay_s, to_seconds(*round_trip) - 2.0 * kDelay);
    }
  }

  [[nodiscard]] Submap window_until(std::size_t next) const {
    Submap window;
    for (std::size_t k = next > 10 ? next - 10 : 0; k < next; ++k) {
      window.keyframes.push_back(drive_.keyframes[k]);
      if (k + 1 < next) window.edges.push_back(drive_.edges[k]);
    }
    return window;
  }

  void start(Robot& robot, double s) {
    RobotSession session;
    session.robot = "robot_" + std::to_string(&robot - robots_.data());
    session.session = SessionNumber{1};
    session.start_stamp = at(s);
    session.stereo = some_stereo();
    session.start = MapOdomEstimate{};
    robot.client->start_session(session, at(s));
    robot.is_started = true;
  }

  Submap drive_ = long_drive();
  MemoryNetwork network_;
  std::unique_ptr<Channel> cloud_;
  std::vector<Robot> robots_;
  std::shared_ptr<const LaserMap> map_ =
      std::make_shared<const LaserMap>(build_map({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}},
                                                 "map",
                                                 read_map_config(defaults().section("map"))));
  LocalizerPool pool_{"localizer", Incarnation{3}, map_, read_localizer_pool_config(defaults())};
};

void expect_shared(int robots, double loss) {
  Cell cell(robots, loss);
  cell.run(0.0, 30.0);
  cell.forget(30.0);
  cell.run(30.0, 120.0);
  double gap_s = 0.0;
  double delay_s = 0.0;
  for (const auto& robot : cell.robots()) {
    gap_s = std::max(gap_s, robot.longest_gap_s);
    delay_s = std::max(delay_s, robot.longest_delay_s);
  }
  std::printf("%d robots, loss %.1f: fairness %.3f, longest queue %.2f s, without answers %.2f s\n",
              robots,
              loss,
              cell.fairness(),
              delay_s,
              gap_s);
  EXPECT_GE(cell.fairness(), 0.95);
  EXPECT_LT(delay_s, 2.0);
  EXPECT_LT(gap_s, 5.0);
}

TEST(SharedLink, TenRobotsOnAQuarterOfAMegabitPerSecondAreAllServed) {
  expect_shared(10, 0.0);
  expect_shared(10, 0.1);
}

TEST(SharedLink, TwentyRobotsOnAQuarterOfAMegabitPerSecondAreAllServed) {
  expect_shared(20, 0.0);
  expect_shared(20, 0.1);
}

}  // namespace
}  // namespace fleetloc
