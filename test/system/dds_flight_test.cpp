// fleetloc-robot and fleetloc-cloud as separate processes over DDS, in real time.
#include <chrono>
#include <csignal>
#include <iostream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/system/loopback_network.hpp"
#include "test/system/recorded_flight.hpp"

namespace fleetloc {
namespace {

using ::testing::Ge;
using ::testing::Gt;
using ::testing::Le;
using Arguments = std::vector<std::string>;

constexpr std::chrono::seconds kPatience{120};  // only a broken program takes that long

class DdsFlight : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::is_directory(recordings())) {
      GTEST_SKIP() << "there are no recordings in " << recordings();
    }
  }

  [[nodiscard]] Arguments robot(const std::string& qos, const Arguments& more) const {
    Arguments arguments{"--robot-id",
                        "robot_1",
                        "--dataset",
                        vicon_room().folder.string(),
                        "--qos",
                        qos,
                        "--domain",
                        network_.domain(),
                        "--initial-pose",
                        vicon_room().displaced_start_pose(),
                        "--out",
                        run_folder_.string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  [[nodiscard]] Arguments cloud(const std::string& qos) const {
    return {"--name",
            "localizer_1",
            "--map",
            built_map(vicon_room(), scratch_).string(),
            "--qos",
            qos,
            "--domain",
            network_.domain(),
            "--out",
            (scratch_ / "localizer_1").string()};
  }

  /// Plays to a robot and a localizer, which must end well; sessions.json of the robot.
  nlohmann::json fly(const std::string& qos, const Arguments& more) {
    ChildProgram localizer(FLEETLOC_CLOUD, cloud(qos));
    const Outcome flown = run(FLEETLOC_ROBOT, robot(qos, more));
    EXPECT_EQ(flown.exit_code, 0) << flown.errors;
    localizer.signal(SIGTERM);
    const Outcome stopped = localizer.wait();
    EXPECT_EQ(stopped.exit_code, 0) << stopped.errors;
    return parsed_json(scratch_ / "localizer_1" / "sessions.json").at("robot_1");
  }

  const ScratchFolder scratch_;
  const LoopbackNetwork network_;
  const std::filesystem::path run_folder_ = scratch_ / "robot_1";
};

TEST_F(DdsFlight, IsLocalizedInTheLaserMapInRealTime) {
  if (kSanitized) GTEST_SKIP() << "sanitizers are too slow for real time";
  const auto session = fly(network_.qos(), {"--rate", "1"});
  const auto errors = run_errors(run_folder_, vicon_room());
  std::cout << errors.dump() << '\n' << session.dump() << '\n';
  EXPECT_THAT(errors.at("ate").at("median").get<double>(), Le(0.03));
  EXPECT_THAT(errors.at("rotation_deg").at("median").get<double>(), Le(0.5));
  EXPECT_THAT(share_of_frames(run_folder_, "localization_frames.tum"), Ge(0.9));
  EXPECT_THAT(session.at("localized").get<int>(), Gt(0));
  const auto summary = parsed_json(run_folder_ / "summary.json");
  EXPECT_THAT(summary.at("uplink_wire_bytes").get<std::int64_t>(),
              Gt(summary.at("uplink_bytes").get<std::int64_t>()));
}

TEST_F(DdsFlight, FindsItsLocalizerThroughTheProfilesThatShip) {
  if (!has_multicast_interface()) GTEST_SKIP() << "no network interface with multicast";
  const auto session =
      fly(FLEETLOC_SOURCE_DIR "/qos_profiles/lan.xml", {"--rate", "1", "--duration", "8"});
  EXPECT_THAT(session.at("submaps").get<int>(), Gt(0));
  EXPECT_THAT(parsed_json(run_folder_ / "summary.json").at("answers_received").get<int>(), Gt(0));
}

TEST_F(DdsFlight, GivesOdometryWithoutALocalizer) {
  const Outcome outcome =
      run(FLEETLOC_ROBOT, robot(network_.qos(), {"--rate", "0", "--duration", "6"}));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(share_of_frames(run_folder_, "odometry.tum"), Ge(0.5));
  EXPECT_EQ(content_of(run_folder_ / "localization.tum"), "");
  const auto summary = parsed_json(run_folder_ / "summary.json");
  EXPECT_EQ(summary.at("frames"), 121);
  EXPECT_EQ(summary.at("answers_received"), 0);
  EXPECT_TRUE(summary.at("first_localization_s").is_null());
}

TEST_F(DdsFlight, WritesItsResultsWhenInterrupted) {
  ChildProgram robot_1(FLEETLOC_ROBOT, robot(network_.qos(), {"--rate", "1"}));
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  const auto odometry = run_folder_ / "odometry.tum";
  std::error_code absent;
  while (std::chrono::steady_clock::now() < deadline) {
    const auto size = std::filesystem::file_size(odometry, absent);
    if (!absent && size > 0) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  robot_1.signal(SIGINT);
  const Outcome outcome = robot_1.wait();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_EQ(outcome.errors, "");
  const auto frames = parsed_json(run_folder_ / "summary.json").at("frames").get<int>();
  EXPECT_GT(frames, 0);
  EXPECT_LT(frames, 1001);  // of the recording
  const std::string poses = content_of(odometry);
  EXPECT_FALSE(poses.empty());
  EXPECT_TRUE(poses.ends_with('\n'));
}

}  // namespace
}  // namespace fleetloc
