// A robot that is switched on where it is parked, where it sees too little to be found in the map,
// and drives off 40 s later, in a crowd, also in the dark: by images, replayed.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "deploy/evaluation/errors/diagnostics_file.hpp"
#include "shared/core/time.hpp"
#include "shared/geometry/so3.hpp"
#include "shared/trajectory/tum_file.hpp"
#include "test/system/simulated_flight.hpp"

namespace fleetloc {
namespace {

constexpr double kHeld = 15.0;       // [s] after the first frame
constexpr double kDrivesOff = 39.0;  // [s] likewise, a second early

bool is_held(Duration since_begin) {
  return since_begin >= from_seconds(kHeld) && since_begin <= from_seconds(kDrivesOff);
}

/// While it is held.
/// @param begin  the first frame
double bytes_up_per_s(const std::filesystem::path& run, Timestamp begin) {
  std::vector<double> bytes;
  for (const FrameDiagnostics& frame : read_frame_diagnostics(run / "diagnostics.csv")) {
    if (is_held(frame.stamp - begin)) bytes.push_back(frame.uplink_bytes);
  }
  return (bytes.back() - bytes.front()) / (kDrivesOff - kHeld);
}

class ParkedReplay : public testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(,
                         ParkedReplay,
                         testing::Values("", "{kind: black_images, start_s: 17, duration_s: 20}"),
                         [](const auto& lighting) {
                           return *lighting.param == '\0' ? "InTheLight" : "InTheDark";
                         });

TEST_P(ParkedReplay, HoldsItsPoseAndThenDrivesOff) {
  if (kSanitized) GTEST_SKIP() << "too slow with sanitizers; the programs' parts run elsewhere";
  const RecordedFlight flight = simulated_parked();
  const ScratchFolder scratch;
  const auto folder = scratch / "run";
  const auto faults = scratch / "faults.yaml";
  std::ofstream(faults) << "seed: 1\nfaults: [" << GetParam() << "]\n";
  must_run(FLEETLOC_REPLAY,
           {"--dataset",
            flight.folder,
            "--map",
            flight.map,
            "--initial-pose",
            flight.displaced_start_pose(),
            "--faults",
            faults,
            "--out",
            folder});

  const Timestamp begin = first_frame(flight.folder);
  std::optional<Pose> held;
  double moved_m = 0.0;
  double turned_rad = 0.0;
  for (const auto& [stamp, T_odom_body] : read_trajectory(folder / "odometry.tum")) {
    if (!is_held(stamp - begin)) continue;
    if (!held) held = T_odom_body;
    moved_m = std::max(moved_m, (T_odom_body.p - held->p).norm());
    turned_rad = std::max(turned_rad, log_so3(held->R.conjugate() * T_odom_body.R).norm());
  }
  ASSERT_TRUE(held);
  EXPECT_LT(moved_m, 0.01);
  EXPECT_LT(turned_rad, 0.1 * M_PI / 180.0);

  const auto summary = parsed_json(folder / "summary.json");
  const double rmse_m =
      odometry_errors(folder, flight).at("translation_m").at("rmse").get<double>();
  const double up = bytes_up_per_s(folder, begin);
  std::cout << summary.dump() << "\nmoved " << 1e3 * moved_m << " mm, turned "
            << turned_rad * 180.0 / M_PI << " degrees, " << up << " B/s up; odometry " << rmse_m
            << " m\n";
  EXPECT_GT(summary.at("standstill_s").get<double>(), kDrivesOff - kHeld);
  EXPECT_LT(summary.at("keyframes").get<int>(), 75) << "100 if it never stood";
  EXPECT_LT(up, 100.0);
  EXPECT_EQ(summary.at("resets"), 0);
  EXPECT_LT(rmse_m, 0.03) << "as that of the robot that drives off at once";
}

}  // namespace
}  // namespace fleetloc
