// fleetloc-play and fleetloc-robot as separate processes: a recording as topics of ROS 2.
#include <csignal>
#include <fstream>
#include <iostream>
#include <ostream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robot/dataset/dataset_reader.hpp"
#include "test/system/live_fixture.hpp"

namespace fleetloc {
namespace {

using ::testing::Ge;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kRobot = "robot_1";

/// A flight, and how much of it is played in real time.
struct LiveCase {
  const char* name;
  RecordedFlight (*flight)();
  const char* duration_s;
};
void PrintTo(const LiveCase& one, std::ostream* stream) {
  *stream << one.name;
}

class LiveFlight : public LiveFixture, public testing::WithParamInterface<LiveCase> {
 protected:
  void SetUp() override {
    if (kSanitized) GTEST_SKIP() << "sanitizers are too slow for real time";
    flight_ = GetParam().flight();
    if (const auto reason = why_missing(flight_)) GTEST_SKIP() << *reason;
    describe_sensors();
  }
};

TEST_P(LiveFlight, UsesNearlyAllPairsThatArePlayed) {
  const double duration_s = std::stod(GetParam().duration_s);
  ChildProgram robot(FLEETLOC_ROBOT, live_robot(kRobot));
  const Outcome played = run(FLEETLOC_PLAY,
                             {flight_.folder.string(),
                              "--sensors",
                              sensors_.string(),
                              "--duration",
                              GetParam().duration_s,
                              "--wait",
                              "60"});
  robot.signal(SIGTERM);
  const Outcome flown = robot.wait();
  EXPECT_EQ(played.exit_code, 0) << played.errors;
  EXPECT_THAT(played.output, Not(HasSubstr("nobody reads")));
  EXPECT_EQ(flown.exit_code, 0) << flown.errors;
  const auto summary = parsed_json(folder_of(kRobot) / "summary.json");
  std::cout << summary.dump() << '\n';
  const auto& faults = summary.at("input_faults");
  const DatasetReader recording({.folder = flight_.folder, .duration_s = duration_s});
  const double pairs = summary.at("frames").get<double>() - faults.value("unpaired_images", 0.0);
  EXPECT_THAT(pairs, Ge(0.99 * static_cast<double>(*recording.frame_count())));
  EXPECT_THAT(share_of_frames(folder_of(kRobot), "odometry.tum"), Ge(0.8));
}

INSTANTIATE_TEST_SUITE_P(Simulated,
                         LiveFlight,
                         testing::Values(LiveCase{"Room", simulated_room, "25"}),
                         [](const auto& one) { return std::string(one.param.name); });
INSTANTIATE_TEST_SUITE_P(Recorded,
                         LiveFlight,
                         testing::Values(LiveCase{"Flight", vicon_room, "25"}),
                         [](const auto& one) { return std::string(one.param.name); });

}  // namespace
}  // namespace fleetloc
