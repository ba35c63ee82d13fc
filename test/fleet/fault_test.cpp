// One fault at a time in a fleet of containers: two localizers and four robots that drive through a
// made-up world, in real time. Run folders are the evidence.
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/fleet/driving_fleet.hpp"
#include "test/system/driven_world.hpp"
#include "test/system/run_watch.hpp"

namespace fleetloc {
namespace {

namespace fs = std::filesystem;
using ::testing::Each;
using ::testing::HasSubstr;

using Words = std::vector<std::string>;

constexpr double kFaultAt = 12.0;  // into the drive of robot_1 [s]
constexpr double kUnderWay = 6.0;  // likewise of any robot: it has answers [s]
constexpr double kDrive = 50.0;    // of each robot [s]
// At most [s of data]: once nothing is in the way, and when the other localizer has to take over.
constexpr double kAnsweredAfter = 5.0;
constexpr double kTakenOverAfter = 10.0;

/// How far each robot's data were, by its run.
using Moment = std::map<std::string, Timestamp>;

class Fault : public testing::Test {
 protected:
  void SetUp() override {
    if (kSanitized) GTEST_SKIP() << "sanitizers are too slow for real time";
    if (const auto reason = DockerFleet::why_impossible()) GTEST_SKIP() << *reason;
    world_ = DrivenWorld::kept();
    robots_ = {{"robot_1", "east", world_.forward, 0.0},
               {"robot_2", "east", world_.reverse, 0.0},
               {"robot_3", "west", world_.forward, 20.0},
               {"robot_4", "west", world_.reverse, 20.0}};
    const auto runs = scratch_ / "runs";
    fs::create_directories(runs);
    fleet_.emplace(runs, world_.map, kDrive);
  }

  [[nodiscard]] const DockerFleet& containers() const { return fleet_->containers(); }

  /// Once there is who serves them; until the first robot is so far into its drive, and all are on
  /// their way.
  void start_robots() {
    for (const std::string& name : localizers_) fleet_->wait_until_it_serves(name);
    for (const DrivingRobot& robot : robots_) fleet_->start_robot(robot, robot.id);
    for (const DrivingRobot& robot : robots_) {
      wait_for_data(fleet_->folder_of(robot.id), std::chrono::duration<double>(kUnderWay));
    }
    wait_until(kFaultAt);
  }

  void start_all() {
    fleet_->start_discovery();
    for (const std::string& name : localizers_) fleet_->start_localizer(name);
    start_robots();
  }

  void wait_until(double data_s) const {
    wait_for_data(fleet_->folder_of("robot_1"), std::chrono::duration<double>(data_s));
  }

  [[nodiscard]] Moment now() const {
    Moment moment;
    for (const DrivingRobot& robot : robots_) moment[robot.id] = fleet_->reached(robot.id);
    return moment;
  }

  /// What tells why a run went wrong.
  [[nodiscard]] std::string account_of(const std::string& run) const {
    return run + '\n' + containers().logs(run) + content_of(fleet_->folder_of(run) / "answers.csv");
  }

  /// What must be true of a run, whatever happened while it drove. Its `confidence`.
  nlohmann::json expect_honest_and_whole(const DrivingRobot& robot, const std::string& run) {
    const auto folder = fleet_->folder_of(run);
    auto confidence = run_errors(folder, robot.flight).at("confidence");
    EXPECT_EQ(confidence.at("confidently_wrong"), 0) << account_of(run);
    EXPECT_EQ(damage_of(folder), "");
    return confidence;
  }

  nlohmann::json expect_localized_at_the_end(const DrivingRobot& robot, const std::string& run) {
    EXPECT_EQ(containers().wait(run), 0) << containers().logs(run);
    EXPECT_EQ(frames_of(fleet_->folder_of(run)).back().state, "localized") << account_of(run);
    return expect_honest_and_whole(robot, run);
  }

  /// All drive to their end and are as they must be; answers came again within `limit_s` of `back`.
  void expect_all_well(const Moment& began, const Moment& back, double limit_s = kAnsweredAfter) {
    std::printf("%-9s %16s %16s %16s %13s\n",
                "robot",
                "no answers for",
                "answered after",
                "localized after",
                "worst error");
    for (const DrivingRobot& robot : robots_) {
      const auto confidence = expect_localized_at_the_end(robot, robot.id);
      const auto run = fleet_->folder_of(robot.id);
      const double after_s = until_answer(run, back.at(robot.id));
      EXPECT_LE(after_s, limit_s) << account_of(robot.id);
      std::printf("%-9s %14.1f s %14.1f s %14.1f s %11.3f m\n",
                  robot.id.c_str(),
                  longest_silence(run, began.at(robot.id)),
                  after_s,
                  until_localized(run, back.at(robot.id)),
                  confidence.at("worst_m").get<double>());
    }
    std::fflush(stdout);
    for (const std::string& name : localizers_) {
      EXPECT_EQ(containers().stop(name), 0) << containers().logs(name);
      EXPECT_EQ(damage_of(fleet_->folder_of(name)), "");
    }
  }

  const ScratchFolder scratch_;
  DrivenWorld world_;
  std::vector<DrivingRobot> robots_;
  Words localizers_{"localizer_1", "localizer_2"};  // those that run at the end
  std::optional<DrivingFleet> fleet_;               // goes before the folder that it writes to
};

TEST_F(Fault, None) {
  start_all();
  const Moment began = now();
  expect_all_well(began, began);
}

TEST_F(Fault, ALocalizerIsKilledAndRestarted) {
  start_all();
  const std::string victim = fleet_->busiest(robots_);
  const Moment began = now();
  containers().kill(victim);
  wait_until(kFaultAt + 8.0);
  fleet_->start_again(victim);
  expect_all_well(began, began, kTakenOverAfter);
}

TEST_F(Fault, BothLocalizersAreKilled) {
  start_all();
  const Moment began = now();
  for (const std::string& name : localizers_) containers().kill(name);
  wait_until(kFaultAt + 10.0);
  for (const std::string& name : localizers_) fleet_->start_again(name);
  for (const std::string& name : localizers_) fleet_->wait_until_it_serves(name);
  expect_all_well(began, now());
}

TEST_F(Fault, ALocalizerIsPausedFor15Seconds) {
  start_all();
  const std::string victim = fleet_->busiest(robots_);
  const Moment began = now();
  containers().pause(victim);
  wait_until(kFaultAt + 15.0);
  containers().unpause(victim);
  expect_all_well(began, began, kTakenOverAfter);
}

TEST_F(Fault, ARobotLosesItsNetworkAndReturnsWithAnotherAddressThenTheSame) {
  start_all();
  const Moment began = now();
  containers().pull_out("east", "robot_1");
  wait_until(kFaultAt + 6.0);
  containers().plug_in("east", "robot_1", 200);
  const Moment back = now();
  wait_until(kFaultAt + 15.0);
  containers().pull_out("east", "robot_1");
  wait_until(kFaultAt + 21.0);
  containers().plug_in("east", "robot_1", 200);
  const Timestamp back_again = fleet_->reached("robot_1");
  expect_all_well(began, back);
  const double after_s = until_answer(fleet_->folder_of("robot_1"), back_again);
  std::cout << "with the same address: answered after " << after_s << " s\n";
  EXPECT_LE(after_s, kAnsweredAfter);
}

TEST_F(Fault, ARobotIsKilledAndRestarted) {
  start_all();
  const Moment began = now();
  DrivingRobot killed = robots_.front();
  containers().kill(killed.id);
  expect_honest_and_whole(killed, killed.id);
  robots_.erase(robots_.begin());

  killed.start_s = kFaultAt + 3.0;
  fleet_->start_robot(killed, "robot_1_again");
  expect_localized_at_the_end(killed, "robot_1_again");
  const auto run = fleet_->folder_of("robot_1_again");
  std::cout << "robot_1 again: localized " << until_localized(run, frames_of(run).front().stamp)
            << " s after its first frame\n";
  expect_all_well(began, began);
}

TEST_F(Fault, TheDiscoveryServerIsKilledAndRestarted) {
  start_all();
  const Moment began = now();
  containers().kill("discovery");
  wait_until(kFaultAt + 10.0);
  containers().start_again("discovery");
  expect_all_well(began, began);  // who has met goes on
}

TEST_F(Fault, AMapIsMissingOrCorrupt) {
  const auto corrupt = fleet_->folder_of("corrupt.pcd");
  const auto missing = fleet_->folder_of("missing.pcd");
  fs::copy_file(world_.map, corrupt);
  fs::copy_file(fs::path(world_.map).replace_extension("yaml"),
                fs::path(corrupt).replace_extension("yaml"));
  fs::resize_file(corrupt, fs::file_size(corrupt) / 2);
  constexpr int kRetries = 2;
  const Words restart{"--restart", "on-failure:" + std::to_string(kRetries)};
  fleet_->start_discovery();
  fleet_->start_localizer("localizer_1");
  fleet_->start_localizer("localizer_2", corrupt, restart);
  fleet_->start_localizer("localizer_3", missing, restart);
  localizers_ = {"localizer_1"};
  start_robots();
  const Moment began = now();

  const std::vector<std::pair<std::string, fs::path>> refused{{"localizer_2", corrupt},
                                                              {"localizer_3", missing}};
  for (const auto& [name, map] : refused) {
    EXPECT_EQ(containers().inspect(name, "{{.State.Status}} {{.State.ExitCode}} {{.RestartCount}}"),
              "exited 2 " + std::to_string(kRetries));
    std::istringstream logs(containers().logs(name));
    Words lines;
    for (std::string line; std::getline(logs, line);) lines.push_back(line);
    EXPECT_EQ(lines.size(), 1U + kRetries);
    EXPECT_THAT(lines, Each(HasSubstr(map.string())));
    std::cout << name << ": " << lines.front() << '\n';
  }
  expect_all_well(began, began);
}

TEST_F(Fault, ALocalizerReachesItsMemoryLimit) {
  fleet_->start_discovery();
  fleet_->start_localizer("localizer_1");
  // Less than its map takes: what its sessions take on top may have room in what it has freed.
  fleet_->start_localizer("localizer_2", {"--memory", "96m", "--memory-swap", "96m"});
  localizers_ = {"localizer_1"};
  start_robots();
  const Moment began = now();
  EXPECT_EQ(containers().inspect("localizer_2", "{{.State.Status}} {{.State.ExitCode}}"),
            "exited 137");
  expect_all_well(began, began, kTakenOverAfter);
}

}  // namespace
}  // namespace fleetloc
