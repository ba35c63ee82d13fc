// A robot that is switched on where it is parked, and drives off 40 s later: by images, replayed. It
// sees too little there to be found in the map.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "shared/geometry/so3.hpp"
#include "shared/trajectory/tum_file.hpp"
#include "test/system/simulated_flight.hpp"

namespace fleetloc {
namespace {

constexpr double kHeld = 15.0;       // [s] after the first frame
constexpr double kDrivesOff = 39.0;  // [s] likewise, a second early

/// While it is held.
double bytes_up_per_s(const std::filesystem::path& run, double begin_s) {
  std::ifstream stream(run / "diagnostics.csv");
  std::string line;
  std::getline(stream, line);
  const auto cells_of = [](const std::string& text) {
    std::vector<std::string> cells;
    std::istringstream words(text);
    for (std::string cell; std::getline(words, cell, ',');) cells.push_back(cell);
    return cells;
  };
  const auto names = cells_of(line);
  const auto column = std::ranges::find(names, "uplink_bytes") - names.begin();
  std::vector<double> bytes;
  while (std::getline(stream, line)) {
    const auto cells = cells_of(line);
    const double t = std::stod(cells.front()) - begin_s;
    if (t >= kHeld && t <= kDrivesOff) {
      bytes.push_back(std::stod(cells.at(static_cast<std::size_t>(column))));
    }
  }
  return (bytes.back() - bytes.front()) / (kDrivesOff - kHeld);
}

TEST(ParkedReplay, HoldsItsPoseAndThenDrivesOff) {
  if (kSanitized) GTEST_SKIP() << "too slow with sanitizers; the programs' parts run elsewhere";
  const RecordedFlight flight = simulated_parked();
  const ScratchFolder scratch;
  const auto folder = scratch / "run";
  must_run(FLEETLOC_REPLAY,
           {"--dataset",
            flight.folder,
            "--map",
            flight.map,
            "--initial-pose",
            flight.displaced_start_pose(),
            "--out",
            folder});

  const double begin_s = to_seconds(first_frame(flight.folder).time_since_epoch());
  std::optional<Pose> held;
  double moved_m = 0.0;
  double turned_rad = 0.0;
  for (const auto& [stamp, T_odom_body] : read_trajectory(folder / "odometry.tum")) {
    const double t = to_seconds(stamp.time_since_epoch()) - begin_s;
    if (t < kHeld || t > kDrivesOff) continue;
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
  const double up = bytes_up_per_s(folder, begin_s);
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
