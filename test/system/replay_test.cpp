// fleetloc-replay on simulated and recorded flights: how far off it is, and that it repeats itself.
#include <iostream>
#include <optional>
#include <ostream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/system/recorded_flight.hpp"
#include "test/system/simulated_flight.hpp"

namespace fleetloc {
namespace {

using ::testing::Ge;
using ::testing::Le;

/// A flight, and what is asked of the replays on it.
struct FlightCase {
  const char* name;
  RecordedFlight (*flight)();
  double odometry_rmse_m = 0.0;
  std::optional<double> first_pose_s = std::nullopt;
  double odometry_share = 0.0;  ///< of the frames
  double median_m = 0.0;        ///< in the map
  double worst_m = 0.0;         ///< while it is localized
  double nees = 2.0;            ///< in the map, per degree of freedom
  double share_in_map = 0.9;    ///< of the frames with a pose in it
  bool drifts = true;           ///< the odometry, by more than the first pose in the map is off
};
void PrintTo(const FlightCase& one, std::ostream* stream) {
  *stream << one.name;
}

class Replay : public testing::TestWithParam<FlightCase> {
 protected:
  void SetUp() override {
    if (kSanitized) GTEST_SKIP() << "too slow with sanitizers; the programs' parts run elsewhere";
    flight_ = GetParam().flight();
    if (const auto reason = why_missing(flight_)) GTEST_SKIP() << *reason;
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

  [[nodiscard]] std::vector<std::string> in_map() const {
    return {"--map",
            built_map(flight_, scratch_).string(),
            "--initial-pose",
            flight_.displaced_start_pose()};
  }

  const ScratchFolder scratch_;
  RecordedFlight flight_;
};

/// Without ground truth and scan: the programs under test have no access to them.
void link_sensors(const std::filesystem::path& dataset, const std::filesystem::path& copy) {
  std::filesystem::create_directories(copy / "mav0");
  for (const char* sensor : {"cam0", "cam1", "imu0"}) {
    std::filesystem::create_directory_symlink(std::filesystem::canonical(dataset / "mav0" / sensor),
                                              copy / "mav0" / sensor);
  }
}

class ReplayedOdometry : public Replay {};

TEST_P(ReplayedOdometry, KeepsTrack) {
  const auto folder = replay("odometry", flight_.folder);
  const auto errors = odometry_errors(folder, flight_);
  const auto first_pose_s = parsed_json(folder / "summary.json").at("first_pose_s").get<double>();
  const double share = share_of_frames(folder, "odometry.tum");
  std::cout << errors.dump() << "\nfirst pose after " << first_pose_s << " s, poses for " << share
            << " of the frames\n";
  EXPECT_THAT(errors.at("translation_m").at("rmse").get<double>(), Le(GetParam().odometry_rmse_m));
  EXPECT_THAT(first_pose_s, Le(GetParam().first_pose_s.value_or(first_pose_s)));
  EXPECT_THAT(share, Ge(GetParam().odometry_share));
  EXPECT_EQ(content_of(folder / "localization_frames.tum"), "");  // no map, no pose in it
}

INSTANTIATE_TEST_SUITE_P(Simulated,
                         ReplayedOdometry,
                         testing::Values(FlightCase{.name = "Room",
                                                    .flight = simulated_room,
                                                    .odometry_rmse_m = 0.03,
                                                    .first_pose_s = 2.0,
                                                    .odometry_share = 0.94},
                                         FlightCase{.name = "Street",
                                                    .flight = simulated_street,
                                                    .odometry_rmse_m = 0.03,
                                                    .first_pose_s = 2.0,
                                                    .odometry_share = 0.94}),
                         [](const auto& one) { return std::string(one.param.name); });
INSTANTIATE_TEST_SUITE_P(
    Recorded,
    ReplayedOdometry,
    testing::Values(FlightCase{.name = "HandHeld",  // all of it is real
                               .flight = machine_hall,
                               .odometry_rmse_m = 0.006,
                               .first_pose_s = 2.5,
                               .odometry_share = 0.84},
                    FlightCase{.name = "Flight", .flight = vicon_room, .odometry_rmse_m = 0.008}),
    [](const auto& one) { return std::string(one.param.name); });

class ReplayInAMap : public Replay {};

TEST_P(ReplayInAMap, IsLocalized) {
  const std::vector<std::string> localized = in_map();
  const auto folder = replay("localized", flight_.folder, localized);
  const auto errors = run_errors(folder, flight_);
  const double share = share_of_frames(folder, "localization_frames.tum");
  std::cout << "localized   " << errors.dump() << ", poses for " << share << " of the frames\n";
  EXPECT_THAT(errors.at("ate").at("median").get<double>(), Le(GetParam().median_m));
  EXPECT_THAT(errors.at("rotation_deg").at("median").get<double>(), Le(0.5));
  EXPECT_THAT(share, Ge(GetParam().share_in_map));
  EXPECT_THAT(errors.at("nees").at("map").get<double>(), Le(GetParam().nees));
  EXPECT_THAT(errors.at("confidence").at("worst_m").get<double>(), Le(GetParam().worst_m));
  EXPECT_EQ(errors.at("confidence").at("confidently_wrong"), 0);
  EXPECT_THAT(parsed_json(folder / "sessions.json").size(), 1);

  std::vector<std::string> once = localized;
  once.emplace_back("--align-once");
  const auto control = replay("align_once", flight_.folder, once);
  const auto errors_once = run_errors(control, flight_);
  std::cout << "align once  " << errors_once.dump() << '\n';
  if (GetParam().drifts) {
    EXPECT_GT(errors_once.at("ate").at("median"), errors.at("ate").at("median"));
  }
  EXPECT_EQ(parsed_json(control / "summary.json").at("answers_applied"), 1);
}

INSTANTIATE_TEST_SUITE_P(Simulated,
                         ReplayInAMap,
                         testing::Values(FlightCase{.name = "Room",
                                                    .flight = simulated_room,
                                                    .median_m = 0.03,
                                                    .worst_m = 0.1},
                                         FlightCase{.name = "Street",
                                                    .flight = simulated_street,
                                                    .median_m = 0.15,
                                                    .worst_m = 0.25,
                                                    .nees = 3.0,  // 2 is wanted
                                                    .share_in_map = 0.5,
                                                    .drifts = false}),
                         [](const auto& one) { return std::string(one.param.name); });
INSTANTIATE_TEST_SUITE_P(
    Recorded,
    ReplayInAMap,
    testing::Values(FlightCase{
        .name = "Flight", .flight = vicon_room, .median_m = 0.012, .worst_m = 0.05}),
    [](const auto& one) { return std::string(one.param.name); });

class RepeatedReplay : public Replay {};

TEST_P(RepeatedReplay, IsTheSameBitForBitAndDoesNotLookAhead) {
  const std::vector<std::string> localized = in_map();
  const auto sensors = scratch_ / "sensors";
  link_sensors(flight_.folder, sensors);
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

INSTANTIATE_TEST_SUITE_P(Simulated,
                         RepeatedReplay,
                         testing::Values(FlightCase{.name = "Room", .flight = simulated_room}),
                         [](const auto& one) { return std::string(one.param.name); });
INSTANTIATE_TEST_SUITE_P(Recorded,
                         RepeatedReplay,
                         testing::Values(FlightCase{.name = "Flight", .flight = vicon_room}),
                         [](const auto& one) { return std::string(one.param.name); });

}  // namespace
}  // namespace fleetloc
