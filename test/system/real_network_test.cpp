// Robots and a localizer as programs on two computers, with a poor line between them. What its
// interfaces count is what the programs say.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "deploy/evaluation/errors/diagnostics_file.hpp"
#include "test/system/driven_world.hpp"
#include "test/system/poor_line.hpp"
#include "test/system/recorded_flight.hpp"
#include "test/system/run_watch.hpp"

namespace fleetloc {
namespace {

using Words = PoorLine::Words;

constexpr double kAgreement = 0.05;

class RealNetwork : public testing::Test {
 protected:
  void SetUp() override {
    if (kSanitized) GTEST_SKIP() << "sanitizers are too slow for real time";
    if (const auto reason = PoorLine::why_impossible()) GTEST_SKIP() << *reason;
    world_ = DrivenWorld::kept();
  }

  static void wait_for(const std::filesystem::path& file) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (!std::filesystem::exists(file)) {
      if (std::chrono::steady_clock::now() > deadline) throw std::runtime_error("does not serve");
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }

  static void wait_for_answer(const std::filesystem::path& run) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(25);
    while (std::chrono::steady_clock::now() < deadline) {
      if (std::filesystem::exists(run / "answers.csv") && !answers_of(run).empty()) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    ADD_FAILURE() << "there is no answer for " << run.filename();
  }

  /// 30 s of a drive.
  [[nodiscard]] Words robot(const std::string& name) const {
    const bool is_odd = (name.back() - '0') % 2 != 0;
    const RecordedFlight& drive = is_odd ? world_.forward : world_.reverse;
    return {"--robot-id",
            name,
            "--dataset",
            drive.folder.string(),
            "--tracks",
            "--duration",
            "30",
            "--qos",
            profile_.string(),
            "--initial-pose",
            drive.displaced_start_pose(),
            "--out",
            (out_ / name).string()};
  }

  void drive(const PoorLine::Config& config, const std::vector<std::string>& names) {
    PoorLine line(config);
    const auto cloud_folder = out_ / "localizer_1";
    const auto localizer = line.start_for_localizers(FLEETLOC_CLOUD,
                                                     {"--name",
                                                      "localizer_1",
                                                      "--map",
                                                      world_.map.string(),
                                                      "--qos",
                                                      profile_.string(),
                                                      "--out",
                                                      cloud_folder.string()});
    wait_for(cloud_folder / "status.csv");
    if (loses_at_once_) line.begin_to_lose();
    std::vector<std::unique_ptr<ChildProgram>> robots;
    for (const std::string& name : names) {
      robots.push_back(line.start_for_robots(FLEETLOC_ROBOT, robot(name)));
      if (robots.size() == 1) line.let_robots_receive();
    }
    for (const std::string& name : names) wait_for_answer(out_ / name);
    if (!loses_at_once_) line.begin_to_lose();
    for (const auto& program : robots) {
      const Outcome end = program->wait();
      ASSERT_EQ(end.exit_code, 0) << end.errors;
    }
    counters_ = line.counters();
    localizer->signal(SIGTERM);
    EXPECT_EQ(localizer->wait().exit_code, 0);
  }

  [[nodiscard]] nlohmann::json summary_of(const std::string& name) const {
    return parsed_json(out_ / name / "summary.json");
  }

  /// Of one robot.
  nlohmann::json drive_alone(const PoorLine::Config& config) {
    drive(config, {"robot_1"});
    return HasFatalFailure() ? nlohmann::json() : summary_of("robot_1");
  }

  void expect_agreement(const nlohmann::json& summary) const {
    const double up = summary.at("uplink_wire_bytes");
    const double down = summary.at("downlink_wire_bytes");
    const double duration_s = summary.at("duration_s");
    const double arrived = counters_.received - counters_.dropped;
    std::cout << "up " << up / duration_s << " B/s by the program, "
              << counters_.offered / duration_s << " offered, " << counters_.sent / duration_s
              << " sent\ndown " << down / duration_s << " B/s by the program, "
              << arrived / duration_s << " arrived, " << counters_.dropped / duration_s
              << " dropped\nanswers " << summary.at("answers_received") << ", coverage "
              << summary.at("coverage") << '\n';
    EXPECT_NEAR(up, counters_.offered, kAgreement * counters_.offered);
    EXPECT_NEAR(down, arrived, kAgreement * arrived);
    EXPECT_LE(counters_.sent, 1.01 * counters_.offered);
  }

  static std::filesystem::path profile(const std::string& name) {
    return std::filesystem::path(FLEETLOC_SOURCE_DIR) / "qos_profiles" / name;
  }

  std::filesystem::path profile_ = profile("lan.xml");
  bool loses_at_once_ = false;  ///< else from the first answers on: discovery is not what is tested
  DrivenWorld world_;
  ScratchFolder out_;
  PoorLine::Counters counters_;
};

TEST_F(RealNetwork, CountsWhatTheProgramsCountOnACleanLine) {
  const auto summary = drive_alone({});
  expect_agreement(summary);
  EXPECT_NEAR(counters_.sent, counters_.offered, 0.01 * counters_.offered);
  EXPECT_GT(summary.at("answers_applied"), 20);
}

// In the profile `lan` no robot finds a localizer here, since discovery is in its own way.
TEST_F(RealNetwork, CountsWhatTheProgramsCountOnASlowLongAndLossyLine) {
  profile_ = profile("nbiot.xml");
  loses_at_once_ = true;
  const auto summary = drive_alone(
      {.loss_percent = 10, .delay = std::chrono::milliseconds(500), .bytes_per_s = 4000});
  expect_agreement(summary);
  EXPECT_GT(summary.at("answers_applied"), 5);
}

TEST_F(RealNetwork, CountsWhatTheProgramsCountWhereHalfIsLost) {
  const auto summary = drive_alone({.loss_percent = 50});
  expect_agreement(summary);
  EXPECT_GT(counters_.dropped, 0.3 * counters_.received);
  EXPECT_GT(summary.at("answers_applied"), 10);
}

// Four tenths of what ten robots have in a cell of NB-IoT. In the profile `lan` their discovery
// fills the line for the first twenty seconds: answers come after 3 to 5 s then.
TEST_F(RealNetwork, FourRobotsShareANarrowLine) {
  profile_ = profile("nbiot.xml");
  const std::vector<std::string> names{"robot_1", "robot_2", "robot_3", "robot_4"};
  drive({.loss_percent = 10, .delay = std::chrono::milliseconds(300), .bytes_per_s = 12'500},
        names);
  if (HasFatalFailure()) return;
  double sum = 0.0;
  double squares = 0.0;
  for (const std::string& name : names) {
    const auto summary = summary_of(name);
    double longest_s = 0.0;
    for (const FrameDiagnostics& frame : read_frame_diagnostics(out_ / name / "diagnostics.csv")) {
      longest_s = std::max(longest_s, frame.round_trip_s.value_or(0.0));
    }
    const double queue_s = longest_s - 2 * 0.3;
    const double up =
        summary.at("uplink_bytes").get<double>() / summary.at("duration_s").get<double>();
    std::cout << name << ": " << up << " B/s of payload up, " << summary.at("answers_applied")
              << " answers, a queue of " << queue_s << " s at most\n";
    EXPECT_GT(summary.at("answers_applied"), 20);
    EXPECT_LT(queue_s, 2.0);
    sum += up;
    squares += up * up;
  }
  EXPECT_GT(sum * sum / (4.0 * squares), 0.95) << "Jain's index";
}

}  // namespace
}  // namespace fleetloc
