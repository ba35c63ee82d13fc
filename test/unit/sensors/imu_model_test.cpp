#include "deploy/sim/sensors/imu_model.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "deploy/sim/motion/vibration.hpp"
#include "deploy/sim/motion/waypoint_motion.hpp"
#include "robot/inertial/preintegration.hpp"
#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

constexpr ImuNoise kNoise{1.7e-4, 1.9e-5, 3.0e-3, 3.0e-3};
constexpr Timestamp kStart{std::chrono::seconds(1000)};

SplineMotion vibrating_drive() {
  WaypointRoute route;
  route.waypoints_m = {{0, 0, 0}, {10, 0, 0.4}, {10, 8, 0}, {0, 8, 0}};
  route.loop = true;
  route.laps = 2;
  const MotionMagnitudes limits{1.5, 1.0, 0.8, 3.0};
  const VibrationConfig vibration{.height_m = 0.004, .pitch_rad = 0.009, .roll_rad = 0.007};
  return with_vibration(drive(route, limits), vibration, Eigen::Vector3d::UnitX(), 1);
}

SplineMotion standstill(double duration_s) {
  return spline_through(grid_over(duration_s, 0.5), [](double) { return Pose{}; });
}

ImuModelConfig perfect() {
  return {.noise = {}};
}

/// What the robot's own integration makes of the samples of ten seconds.
double error_after_10_s(const SplineMotion& motion, std::size_t first) {
  const ImuRecord record = measured_imu(motion, perfect(), kStart, 1);
  const std::span<const ImuSample> samples(record.samples.begin() + static_cast<long>(first), 2001);
  const Preintegration preintegration(samples, {}, kNoise);
  const auto state_at = [&](const ImuSample& sample) {
    return motion.at(to_seconds(sample.stamp - kStart));
  };
  const MotionState begin = state_at(samples.front());
  const NavState end =
      preintegration.predict({.T_odom_body = begin.T_map_body, .v_odom = begin.v_map, .bias = {}});
  return (end.T_odom_body.p - state_at(samples.back()).T_map_body.p).norm();
}

TEST(ImuModel, WithoutNoiseIntegratesToWithinAMillimetreIn10Seconds) {
  const SplineMotion motion = vibrating_drive();
  double worst = 0.0;
  for (std::size_t first = 0; first + 2001 < 12'000; first += 500) {
    worst = std::max(worst, error_after_10_s(motion, first));
  }
  RecordProperty("worst_m", std::to_string(worst));
  std::cout << "worst position error after 10 s: " << worst << " m\n";
  EXPECT_LT(worst, 1e-3);
}

TEST(ImuModel, FeelsGravityAtRest) {
  for (const ImuSample& sample : measured_imu(standstill(2.0), perfect(), kStart, 1).samples) {
    EXPECT_LT((sample.specific_force + kGravity).norm(), 1e-9);
    EXPECT_LT(sample.angular_velocity.norm(), 1e-9);
  }
}

TEST(ImuModel, StampsItsSamplesAtItsRateFromStartToEnd) {
  const ImuRecord record = measured_imu(standstill(2.0), perfect(), kStart, 1);
  ASSERT_EQ(record.samples.size(), 401U);
  ASSERT_EQ(record.biases.size(), 401U);
  EXPECT_EQ(record.samples.front().stamp, kStart);
  EXPECT_EQ(record.samples[1].stamp, kStart + std::chrono::milliseconds(5));
  EXPECT_EQ(record.samples.back().stamp, kStart + std::chrono::seconds(2));
}

TEST(ImuModel, WhiteNoiseHasTheDensityItClaims) {
  ImuModelConfig config = perfect();
  config.noise.gyroscope_noise_density = kNoise.gyroscope_noise_density;
  config.noise.accelerometer_noise_density = kNoise.accelerometer_noise_density;
  const ImuRecord record = measured_imu(standstill(100.0), config, kStart, 5);
  double gyroscope = 0.0;
  double accelerometer = 0.0;
  for (const ImuSample& sample : record.samples) {
    gyroscope += sample.angular_velocity.squaredNorm();
    accelerometer += (sample.specific_force + kGravity).squaredNorm();
  }
  const double values_per_second = 3.0 * static_cast<double>(record.samples.size()) * 200.0;
  EXPECT_NEAR(std::sqrt(gyroscope / values_per_second) / kNoise.gyroscope_noise_density, 1.0, 0.02);
  EXPECT_NEAR(
      std::sqrt(accelerometer / values_per_second) / kNoise.accelerometer_noise_density, 1.0, 0.02);
}

TEST(ImuModel, BiasWalksAsFarAsItClaims) {
  ImuModelConfig config = perfect();
  config.noise.gyroscope_random_walk = kNoise.gyroscope_random_walk;
  config.noise.accelerometer_random_walk = kNoise.accelerometer_random_walk;
  const SplineMotion motion = standstill(4.0);
  constexpr int kRuns = 300;
  double gyroscope = 0.0;
  double accelerometer = 0.0;
  for (std::uint64_t seed = 1; seed <= kRuns; ++seed) {
    const ImuRecord record = measured_imu(motion, config, kStart, seed);
    EXPECT_EQ(record.biases.front().gyroscope.norm(), 0.0);
    const Eigen::Vector3d measured = record.samples.back().angular_velocity;
    EXPECT_LT((measured - record.biases.back().gyroscope).norm(), 1e-9);
    gyroscope += record.biases.back().gyroscope.squaredNorm();
    accelerometer += record.biases.back().accelerometer.squaredNorm();
  }
  const double values_seconds = 3.0 * kRuns * 4.0;
  EXPECT_NEAR(std::sqrt(gyroscope / values_seconds) / kNoise.gyroscope_random_walk, 1.0, 0.08);
  EXPECT_NEAR(
      std::sqrt(accelerometer / values_seconds) / kNoise.accelerometer_random_walk, 1.0, 0.08);
}

TEST(ImuModel, ScaleMisalignmentAndInitialBiasHaveTheSpreadTheyClaim) {
  const SplineMotion motion = standstill(1.0);
  ImuModelConfig config = perfect();
  config.rate_hz = 10.0;
  config.scale_error = 1e-3;
  config.misalignment = 2e-3;
  double scale = 0.0;
  double cross = 0.0;
  constexpr int kRuns = 400;
  for (std::uint64_t seed = 1; seed <= kRuns; ++seed) {
    const Eigen::Vector3d force =
        measured_imu(motion, config, kStart, seed).samples.front().specific_force / 9.81;
    scale += std::pow(force.z() - 1.0, 2) / kRuns;
    cross += force.head<2>().squaredNorm() / (2.0 * kRuns);
  }
  EXPECT_NEAR(std::sqrt(scale) / config.scale_error, 1.0, 0.12);
  EXPECT_NEAR(std::sqrt(cross) / config.misalignment, 1.0, 0.12);

  config = perfect();
  config.rate_hz = 10.0;
  config.initial_gyroscope_bias = 0.01;
  double bias = 0.0;
  for (std::uint64_t seed = 1; seed <= kRuns; ++seed) {
    const ImuRecord record = measured_imu(motion, config, kStart, seed);
    bias += record.samples.back().angular_velocity.squaredNorm() / (3.0 * kRuns);
  }
  EXPECT_NEAR(std::sqrt(bias) / config.initial_gyroscope_bias, 1.0, 0.1);
}

TEST(ImuModel, IsTheSameForOneSeedAndAnotherForAnother) {
  const SplineMotion motion = standstill(1.0);
  const ImuModelConfig config{.noise = kNoise, .initial_gyroscope_bias = 0.01};
  const auto last = [&](std::uint64_t seed) {
    return measured_imu(motion, config, kStart, seed).samples.back().specific_force;
  };
  EXPECT_EQ(last(1), last(1));
  EXPECT_NE(last(1), last(2));
}

}  // namespace
}  // namespace fleetloc
