#include "deploy/sim/motion/recorded_motion.hpp"

#include <cmath>
#include <stdexcept>
#include <vector>

#include <gmock/gmock.h>

#include "shared/core/counter_random.hpp"
#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double kNoise = 0.02;        // [m]
constexpr double kAngleNoise = 0.004;  // [rad]

const MotionMagnitudes kLimits{
    .speed = 2.0, .acceleration = 1.0, .turn_rate = 0.8, .angular_acceleration = 1.0};

/// Rounds of 20 m radius at 1.2 m/s, over a hill.
Pose truth_at(double t) {
  const double angle = 0.06 * t;
  return {.R = exp_so3({0.0, 0.0, angle}),
          .p = {20.0 * std::sin(angle), -20.0 * std::cos(angle), 0.3 * std::sin(0.2 * t)}};
}

/// As recorded at 10 Hz: noise, jitter of the stamps, a repeated one, and some wild poses.
std::vector<StampedPose> record(double duration_s) {
  const CounterRandom random(3, 0);
  std::vector<StampedPose> poses;
  for (std::uint64_t i = 0; 0.1 * static_cast<double>(i) <= duration_s; ++i) {
    const double time_s = 0.1 * static_cast<double>(i);
    Pose T = truth_at(time_s);
    T.p += kNoise * random.normal3(10 * i);
    T.R = T.R * exp_so3(kAngleNoise * random.normal3(10 * i + 1));
    if (i % 97 == 50) T.p += Eigen::Vector3d(2.0, -1.0, 0.5);
    const double jitter_s = i == 0 ? 0.0 : 0.004 * random.normal(10 * i + 2);
    poses.push_back({Timestamp(std::chrono::seconds(1000) + from_seconds(time_s + jitter_s)), T});
  }
  poses[200].stamp = poses[199].stamp;
  std::swap(poses[250], poses[251]);
  return poses;
}

RecordFitConfig config_of(double cutoff_hz) {
  return {.position_cutoff_hz = cutoff_hz, .rotation_cutoff_hz = cutoff_hz, .limits = kLimits};
}

TEST(RecordedMotion, IsNearerToTheTruthThanTheRecordIs) {
  const auto poses = record(120.0);
  const RecordFit fit = fit_record(poses, config_of(0.5));
  EXPECT_TRUE(fit.within_limits);
  EXPECT_EQ(fit.start, poses.front().stamp);
  EXPECT_EQ(fit.repeated_stamps, 1U);
  EXPECT_GE(fit.outliers, 12U);
  double squares = 0.0;
  double worst = 0.0;
  double worst_angle = 0.0;
  for (int i = 0; i <= 1200; ++i) {
    const Pose T = fit.motion.at(0.1 * i).T_map_body;
    const double error = (T.p - truth_at(0.1 * i).p).norm();
    squares += error * error / 1201.0;
    worst = std::max(worst, error);
    worst_angle = std::max(worst_angle, log_so3(T.R.conjugate() * truth_at(0.1 * i).R).norm());
  }
  EXPECT_LT(std::sqrt(squares), 0.6 * std::sqrt(3.0) * kNoise);
  EXPECT_LT(worst, 0.12);  // 2.3 m off is a wild pose
  EXPECT_LT(worst_angle, 3.0 * kAngleNoise);
}

TEST(RecordedMotion, ReportsTheResidualOfTheRecord) {
  const RecordFit fit = fit_record(record(120.0), config_of(0.5));
  EXPECT_NEAR(fit.position_m.median, 1.54 * kNoise, 0.25 * kNoise);
  EXPECT_GT(fit.position_m.p95, fit.position_m.median);
  EXPECT_NEAR(fit.position_m.max, 2.3, 0.2);
  EXPECT_NEAR(fit.rotation_deg.median, 57.3 * 1.54 * kAngleNoise, 57.3 * 0.3 * kAngleNoise);
}

TEST(RecordedMotion, KeepsTheLimitsWhereTheRecordDoesNot) {
  for (const double cutoff_hz : {3.0, 1.5}) {
    const auto poses = record(60.0);
    const RecordFit free = fit_record(poses, [&] {
      RecordFitConfig config = config_of(cutoff_hz);
      config.limits = {1e9, 1e9, 1e9, 1e9};
      return config;
    }());
    const RecordFit fit = fit_record(poses, config_of(cutoff_hz));
    EXPECT_GT(free.greatest.acceleration, 1.5 * kLimits.acceleration);
    EXPECT_TRUE(fit.within_limits);
    EXPECT_LE(fit.greatest.speed, kLimits.speed);
    EXPECT_LE(fit.greatest.acceleration, kLimits.acceleration);
    EXPECT_LE(fit.greatest.turn_rate, kLimits.turn_rate);
    EXPECT_LE(fit.greatest.angular_acceleration, kLimits.angular_acceleration);
    EXPECT_LT(fit.position_m.median, 2.5 * kNoise);
  }
}

TEST(RecordedMotion, SaysWhenTheLimitsCannotBeKept) {
  RecordFitConfig config = config_of(1.0);
  config.limits.speed = 0.5;  // of a robot that makes 1.2 m/s
  config.max_rounds = 5;
  EXPECT_FALSE(fit_record(record(30.0), config).within_limits);
}

TEST(RecordedMotion, RefusesGapsAndRecordsThatAreTooShort) {
  auto poses = record(30.0);
  poses.erase(poses.begin() + 100, poses.begin() + 170);
  EXPECT_THAT([&] { static_cast<void>(fit_record(poses, config_of(1.0))); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("gap of 7.")));
  poses.resize(5);
  EXPECT_THAT([&] { static_cast<void>(fit_record(poses, config_of(1.0))); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("fewer than 8")));
}

}  // namespace
}  // namespace fleetloc
