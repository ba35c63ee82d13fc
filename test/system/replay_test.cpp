// fleetloc-replay on recordings: how far off it is, and that it repeats itself.
#include <iostream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/system/recorded_flight.hpp"

namespace fleetloc {
namespace {

using ::testing::Ge;
using ::testing::Le;

class Replay : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::is_directory(recordings())) {
      GTEST_SKIP() << "there are no recordings in " << recordings();
    }
    if (kSanitized) GTEST_SKIP() << "too slow with sanitizers; the programs' parts run elsewhere";
  }

  /// Replays into a run folder named `name`.
  std::filesystem::path replay(const std::string& name,
                               const std::filesystem::path& dataset,
                               const std::vector<std::string>& more = {}) {
    auto folder = scratch_ / name;
    std::vector<std::string> arguments{"--dataset", dataset.string(), "--out", folder.string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run(FLEETLOC_REPLAY, arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
    return folder;
  }

  const ScratchFolder scratch_;
};

/// Without ground truth and scan: the programs under test have no access to them.
void link_sensors(const std::filesystem::path& dataset, const std::filesystem::path& copy) {
  std::filesystem::create_directories(copy / "mav0");
  for (const char* sensor : {"cam0", "cam1", "imu0"}) {
    std::filesystem::create_directory_symlink(std::filesystem::canonical(dataset / "mav0" / sensor),
                                              copy / "mav0" / sensor);
  }
}

TEST_F(Replay, KeepsTrackOfARealHandHeldRecording) {
  const auto folder = replay("odometry", machine_hall().folder);
  const auto errors = odometry_errors(folder, machine_hall());
  std::cout << errors.dump() << '\n';
  EXPECT_THAT(errors.at("translation_m").at("rmse").get<double>(), Le(0.015));
  EXPECT_THAT(parsed_json(folder / "summary.json").at("first_pose_s").get<double>(), Le(2.5));
  EXPECT_THAT(share_of_frames(folder, "odometry.tum"), Ge(0.84));
}

TEST_F(Replay, KeepsTrackOfAFlight) {
  const auto folder = replay("odometry", vicon_room().folder);
  const auto errors = odometry_errors(folder, vicon_room());
  std::cout << errors.dump() << '\n';
  EXPECT_THAT(errors.at("translation_m").at("rmse").get<double>(), Le(0.04));
  EXPECT_EQ(content_of(folder / "localization_frames.tum"), "");  // no map, no pose in it
}

TEST_F(Replay, LocalizesAFlightInTheLaserMap) {
  const std::vector<std::string> localized{"--map",
                                           built_map(vicon_room(), scratch_).string(),
                                           "--initial-pose",
                                           vicon_room().displaced_start_pose()};
  const auto folder = replay("localized", vicon_room().folder, localized);
  const auto errors = run_errors(folder, vicon_room());
  std::cout << "localized   " << errors.dump() << '\n';
  EXPECT_THAT(errors.at("ate").at("median").get<double>(), Le(0.03));
  EXPECT_THAT(errors.at("rotation_deg").at("median").get<double>(), Le(0.5));
  EXPECT_THAT(share_of_frames(folder, "localization_frames.tum"), Ge(0.9));
  EXPECT_THAT(parsed_json(folder / "sessions.json").size(), 1);

  std::vector<std::string> once = localized;
  once.emplace_back("--align-once");
  const auto control = replay("align_once", vicon_room().folder, once);
  std::cout << "align once  " << run_errors(control, vicon_room()).dump() << '\n';
  EXPECT_EQ(parsed_json(control / "summary.json").at("answers_applied"), 1);
}

TEST_F(Replay, RepeatsItselfBitForBitAndDoesNotLookAhead) {
  const std::vector<std::string> localized{"--map",
                                           built_map(vicon_room(), scratch_).string(),
                                           "--initial-pose",
                                           vicon_room().displaced_start_pose()};
  const auto sensors = scratch_ / "sensors";
  link_sensors(vicon_room().folder, sensors);
  std::vector<std::string> first_30_s = localized;
  first_30_s.insert(first_30_s.end(), {"--duration", "30"});
  const auto once = replay("once", sensors, localized);
  const auto twice = replay("twice", sensors, localized);
  const auto part = replay("part", sensors, first_30_s);
  for (const char* file : {"odometry.tum",
                           "localization.tum",
                           "localization_frames.tum",
                           "diagnostics.csv",
                           "answers.csv"}) {
    const std::string whole = content_of(once / file);
    const std::string beginning = content_of(part / file);
    EXPECT_TRUE(whole == content_of(twice / file)) << file;
    EXPECT_TRUE(whole.starts_with(beginning)) << file;
    EXPECT_THAT(beginning.size(), Ge(whole.size() / 2)) << file;
    EXPECT_LT(beginning.size(), whole.size()) << file;
  }
}

}  // namespace
}  // namespace fleetloc
