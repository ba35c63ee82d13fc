// fleetloc-robot and fleetloc-cloud as separate processes over DDS, in real time.
#include <chrono>
#include <csignal>
#include <iostream>
#include <ostream>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robot/dataset/dataset_reader.hpp"
#include "test/system/dds_fixture.hpp"

namespace fleetloc {
namespace {

using ::testing::ContainsRegex;
using ::testing::Ge;
using ::testing::Gt;
using ::testing::HasSubstr;
using ::testing::Le;

constexpr std::chrono::seconds kPatience{120};  // only a broken program takes that long
constexpr const char* kRobot = "robot_1";
constexpr const char* kLocalizer = "localizer_1";

class DdsFlight : public DdsFixture {
 protected:
  /// Plays to a robot and a localizer, which must end well; sessions.json of the robot.
  nlohmann::json fly(const Arguments& more) {
    ChildProgram localizer(FLEETLOC_CLOUD, cloud(kLocalizer));
    const Outcome flown = run(FLEETLOC_ROBOT, robot(kRobot, more));
    EXPECT_EQ(flown.exit_code, 0) << flown.errors;
    localizer.signal(SIGTERM);
    const Outcome stopped = localizer.wait();
    EXPECT_EQ(stopped.exit_code, 0) << stopped.errors;
    return parsed_json(folder_of(kLocalizer) / "sessions.json").at(kRobot);
  }

  const std::filesystem::path run_folder_ = folder_of(kRobot);
};

/// A flight, and what is asked of the part of it that is played.
struct FlightCase {
  const char* name;
  RecordedFlight (*flight)();
  const char* duration_s;
  double median_m;
};
void PrintTo(const FlightCase& one, std::ostream* stream) {
  *stream << one.name;
}

class DdsFlightThrough : public DdsFlight, public testing::WithParamInterface<FlightCase> {
 protected:
  void SetUp() override {
    if (kSanitized) GTEST_SKIP() << "sanitizers are too slow for real time";
    flight_ = GetParam().flight();
    if (const auto reason = why_missing(flight_)) GTEST_SKIP() << *reason;
    DdsFlight::SetUp();
  }
};

TEST_P(DdsFlightThrough, IsLocalizedInTheLaserMapInRealTime) {
  const auto session = fly({"--rate", "1", "--duration", GetParam().duration_s});
  const auto errors = run_errors(run_folder_, flight_);
  std::cout << errors.dump() << '\n' << session.dump() << '\n';
  EXPECT_THAT(errors.at("ate").at("median").get<double>(), Le(GetParam().median_m));
  EXPECT_THAT(errors.at("rotation_deg").at("median").get<double>(), Le(0.5));
  EXPECT_THAT(share_of_frames(run_folder_, "localization_frames.tum"), Ge(0.9));
  EXPECT_THAT(session.at("localized").get<int>(), Gt(0));
  const auto summary = parsed_json(run_folder_ / "summary.json");
  EXPECT_THAT(summary.at("uplink_wire_bytes").get<std::int64_t>(),
              Gt(summary.at("uplink_bytes").get<std::int64_t>()));
  const Outcome view =
      run(FLEETLOC_MONITOR, {"--run", run_folder_, "--localizer", folder_of(kLocalizer), "--once"});
  EXPECT_THAT(view.output,
              HasSubstr("\nrobot_1  " + std::string(GetParam().duration_s) + " s  ended  "));
  // Its line of each second may fall into the .3 s in which it says goodbye.
  EXPECT_THAT(view.output,
              ContainsRegex("\nlocalizer_1  (accepting|draining)  *1       "));  // robots
}

INSTANTIATE_TEST_SUITE_P(Simulated,
                         DdsFlightThrough,
                         testing::Values(FlightCase{"Room", simulated_room, "25.0", 0.03}),
                         [](const auto& one) { return std::string(one.param.name); });
INSTANTIATE_TEST_SUITE_P(Recorded,
                         DdsFlightThrough,
                         testing::Values(FlightCase{"Flight", vicon_room, "50.0", 0.03}),
                         [](const auto& one) { return std::string(one.param.name); });

class DdsFlightOn : public DdsFlight, public testing::WithParamInterface<const char*> {};

TEST_P(DdsFlightOn, FindsItsLocalizerThroughTheProfilesThatShip) {
  if (!has_multicast_interface()) GTEST_SKIP() << "no network interface with multicast";
  qos_ = std::string(FLEETLOC_SOURCE_DIR "/qos_profiles/") + GetParam() + ".xml";
  const auto session = fly({"--rate", "1", "--duration", "8"});
  EXPECT_THAT(session.at("submaps").get<int>(), Gt(0));
  EXPECT_THAT(parsed_json(run_folder_ / "summary.json").at("answers_received").get<int>(), Gt(0));
}

INSTANTIATE_TEST_SUITE_P(Networks,
                         DdsFlightOn,
                         testing::Values("lan", "wifi", "lte", "nbiot"),
                         [](const auto& it) { return it.param; });

TEST_F(DdsFlight, GivesOdometryWithoutALocalizer) {
  const Outcome outcome = run(FLEETLOC_ROBOT, robot(kRobot, {"--rate", "0", "--duration", "6"}));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(share_of_frames(run_folder_, "odometry.tum"), Ge(0.5));
  EXPECT_EQ(content_of(run_folder_ / "localization.tum"), "");
  const auto summary = parsed_json(run_folder_ / "summary.json");
  EXPECT_EQ(summary.at("frames"), 61);  // in 6 s
  EXPECT_EQ(summary.at("answers_received"), 0);
  EXPECT_TRUE(summary.at("first_localization_s").is_null());
}

TEST_F(DdsFlight, WritesItsResultsWhenInterrupted) {
  ChildProgram robot_1(FLEETLOC_ROBOT, robot(kRobot, {"--rate", "1"}));
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
  const auto frames = parsed_json(run_folder_ / "summary.json").at("frames").get<std::size_t>();
  EXPECT_GT(frames, 0);
  EXPECT_LT(frames, *DatasetReader({.folder = flight_.folder}).frame_count());
  const std::string poses = content_of(odometry);
  EXPECT_FALSE(poses.empty());
  EXPECT_TRUE(poses.ends_with('\n'));
}

}  // namespace
}  // namespace fleetloc
