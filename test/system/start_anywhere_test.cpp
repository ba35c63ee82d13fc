// Odometry that is switched on in the middle of a motion: how soon it knows metres and gravity.
#include <cmath>
#include <iomanip>
#include <iostream>
#include <ostream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/system/simulated_flight.hpp"
#include "test/system/started_odometry.hpp"

namespace fleetloc {
namespace {

using ::testing::Ge;
using ::testing::SizeIs;

constexpr int kStarts = 20;
constexpr StartWatch kWatch{.patience_s = 3.0, .stretch_s = 2.0};
constexpr StartChoice kInMotion{
    .count = kStarts, .min_speed = 0.1, .playing_s = kWatch.patience_s + kWatch.stretch_s};

bool succeeded(const StartOutcome& outcome) {
  return outcome.first_pose_s.value_or(1e9) <= kWatch.patience_s &&
         std::abs(outcome.scale_error) <= 0.05 && outcome.gravity_error_deg <= 1.0;
}

void print(const StartOutcome& outcome) {
  std::cout << std::fixed << std::setprecision(2) << "start " << outcome.start_s << " s: ";
  if (!outcome.first_pose_s) {
    std::cout << "no pose\n";
    return;
  }
  std::cout << "first pose after " << *outcome.first_pose_s << " s, scale error "
            << 100.0 * outcome.scale_error << " % over " << outcome.path_m << " m, gravity error "
            << outcome.first_gravity_error_deg << " deg at first, " << outcome.gravity_error_deg
            << " deg after " << kWatch.patience_s << " s"
            << (succeeded(outcome) ? "\n" : "  FAILED\n");
}

struct Count {
  int metric = 0;     ///< starts with a pose in time and the right scale
  int succeeded = 0;  ///< and with gravity
};

Count count_successes(const RecordedFlight& flight) {
  const std::vector<double> starts = starts_in_motion(flight, kInMotion);
  EXPECT_THAT(starts, SizeIs(kStarts));
  Count count;
  for (const double start_s : starts) {
    const StartOutcome outcome = started_at(start_s, flight, kWatch);
    print(outcome);
    count.metric += outcome.first_pose_s && std::abs(outcome.scale_error) <= 0.05 ? 1 : 0;
    count.succeeded += succeeded(outcome) ? 1 : 0;
  }
  std::cout << count.metric << " metric, " << count.succeeded << " with gravity as well\n";
  return count;
}

/// A flight, and how many of the starts on it must succeed.
struct StartCase {
  const char* name;
  RecordedFlight (*flight)();
  int metric;
  int succeeded;
};
void PrintTo(const StartCase& one, std::ostream* stream) {
  *stream << one.name;
}

class StartAnywhere : public testing::TestWithParam<StartCase> {
 protected:
  void SetUp() override {
    if (kSanitized) GTEST_SKIP() << "too slow with sanitizers; the programs' parts run elsewhere";
    flight_ = GetParam().flight();
    if (const auto reason = why_missing(flight_)) GTEST_SKIP() << *reason;
  }

  RecordedFlight flight_;
};

TEST_P(StartAnywhere, FindsMetresAndMostlyGravity) {
  const Count count = count_successes(flight_);
  EXPECT_THAT(count.metric, Ge(GetParam().metric));
  EXPECT_THAT(count.succeeded, Ge(GetParam().succeeded));
}

INSTANTIATE_TEST_SUITE_P(Simulated,
                         StartAnywhere,
                         testing::Values(StartCase{"Room", simulated_room, 18, 18}),
                         [](const auto& one) { return std::string(one.param.name); });

// Flight: short of the 18 that are wanted, which the recording does not hold: where it turns little
// for 3 s, gravity and the accelerometer's bias (0.16 m/s^2 across gravity, one degree) cannot be
// told apart, and the ground truth that its images are rendered from does not quite fit its IMU. A
// least-squares fit of the IMU to the poses of the ground truth itself finds gravity within one
// degree in 11 to 16 of 20 such stretches, whatever it believes of the bias beforehand.
INSTANTIATE_TEST_SUITE_P(Recorded,
                         StartAnywhere,
                         testing::Values(StartCase{"HandHeld", machine_hall, 18, 18},
                                         StartCase{"Flight", vicon_room, 18, 14}),
                         [](const auto& one) { return std::string(one.param.name); });

}  // namespace
}  // namespace fleetloc
