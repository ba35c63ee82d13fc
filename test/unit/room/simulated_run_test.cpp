#include "deploy/sim/room/simulated_run.hpp"

#include <cmath>
#include <cstddef>
#include <map>
#include <stdexcept>

#include <gmock/gmock.h>

#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

Timestamp at(double time_s) {
  return Timestamp{Duration{std::llround(time_s * 1e9)}};
}

Eigen::Vector3d expected_pixel(const SimulatedRun& run,
                               const TrackedFrame& frame,
                               LandmarkId landmark) {
  const Pose T_room_cam0 = run.truth(frame.stamp).T_odom_body * run.stereo().T_body_cam0;
  return project(run.stereo(), inverse(T_room_cam0) * run.landmark(landmark));
}

bool same(const TrackedFrame& a, const TrackedFrame& b) {
  if (a.stamp != b.stamp || a.observations.size() != b.observations.size()) {
    return false;
  }
  for (std::size_t i = 0; i < a.observations.size(); ++i) {
    const StereoObservation& x = a.observations[i];
    const StereoObservation& y = b.observations[i];
    if (x.landmark != y.landmark || x.left != y.left || x.disparity != y.disparity) {
      return false;
    }
  }
  return true;
}

TEST(SimulatedRun, ObservationsWithoutNoiseAreExactProjections) {
  const SimulatedRun run({});
  for (const int index : {0, 7, 150, 400}) {
    const TrackedFrame frame = run.frame(index);
    EXPECT_EQ(frame.stamp, run.frame_stamp(index));
    ASSERT_GT(frame.observations.size(), 100U);
    int stereo = 0;
    for (std::size_t i = 0; i < frame.observations.size(); ++i) {
      const StereoObservation& seen = frame.observations[i];
      const Eigen::Vector3d pixel = expected_pixel(run, frame, seen.landmark);
      EXPECT_LT((seen.left - pixel.head<2>()).norm(), 1e-9);
      if (seen.disparity > 0.0) {
        EXPECT_NEAR(seen.disparity, pixel[0] - pixel[2], 1e-9);
        ++stereo;
      }
      EXPECT_TRUE(i == 0 || frame.observations[i - 1].landmark < seen.landmark);
    }
    EXPECT_GT(stereo, 80);
  }
}

TEST(SimulatedRun, TracksLastAndNeverComeBack) {
  const SimulatedRun run({});
  std::map<LandmarkId, int> first;
  std::map<LandmarkId, int> last;
  constexpr int kFrames = 400;
  for (int i = 0; i < kFrames; ++i) {
    const TrackedFrame frame = run.frame(i);
    EXPECT_LE(frame.observations.size(), 150U);
    for (const StereoObservation& seen : frame.observations) {
      const bool is_new = first.try_emplace(seen.landmark, i).second;
      EXPECT_TRUE(is_new || last[seen.landmark] == i - 1);
      last[seen.landmark] = i;
    }
  }
  double mean_length = 0.0;
  for (const auto& [landmark, start] : first) {
    mean_length += (last[landmark] - start + 1.0) / static_cast<double>(first.size());
  }
  EXPECT_GT(mean_length, 25.0);
  EXPECT_THROW(static_cast<void>(run.landmark(LandmarkId{1'000'000})), std::out_of_range);
}

TEST(SimulatedRun, IsTheSameInEveryCallOrder) {
  SimulatedRun::Config config;
  config.pixel_sigma = 1.0;
  config.outlier_share = 0.1;
  config.imu_white_noise = true;
  config.imu_bias_walk = true;
  const SimulatedRun forwards(config);
  const SimulatedRun backwards(config);
  for (int i = 0; i <= 30; ++i) {
    static_cast<void>(forwards.frame(i));
  }
  EXPECT_TRUE(same(forwards.frame(30), backwards.frame(30)));
  EXPECT_TRUE(same(forwards.frame(3), backwards.frame(3)));

  const auto early = backwards.imu(at(0.0), at(2.0));
  const auto late = forwards.imu(at(1.0), at(2.0));
  ASSERT_EQ(early.size(), 401U);
  ASSERT_EQ(late.size(), 201U);
  EXPECT_EQ(early[250].stamp, late[50].stamp);
  EXPECT_EQ(early[250].angular_velocity, late[50].angular_velocity);
  EXPECT_EQ(early[250].specific_force, late[50].specific_force);

  config.seed = 2;
  EXPECT_FALSE(same(SimulatedRun(config).frame(30), forwards.frame(30)));
}

TEST(SimulatedRun, FeelsGravityAtRest) {
  SimulatedRun::Config config;
  config.rest_s = 1.0;
  config.initial_bias.gyroscope = {0.01, 0.02, 0.03};
  config.initial_bias.accelerometer = {0.1, 0.2, 0.3};
  const SimulatedRun run(config);
  for (const ImuSample& sample : run.imu(at(0.0), at(1.0))) {
    const Eigen::Vector3d force = sample.specific_force - config.initial_bias.accelerometer;
    const NavState truth = run.truth(sample.stamp);
    EXPECT_LT((truth.T_odom_body.R * force + kGravity).norm(), 1e-12);
    EXPECT_LT((sample.angular_velocity - config.initial_bias.gyroscope).norm(), 1e-15);
    EXPECT_EQ(truth.bias.accelerometer, config.initial_bias.accelerometer);
  }
}

// Independently of robot/inertial: the trapezoidal rule, at a tenth of the usual step.
TEST(SimulatedRun, ImuIntegratesToTheTruth) {
  SimulatedRun::Config config;
  config.imu_rate_hz = 2000.0;
  const SimulatedRun run(config);
  const auto samples = run.imu(at(0.0), at(10.0));
  NavState state = run.truth(at(0.0));
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const double dt = to_seconds(samples[i].stamp - samples[i - 1].stamp);
    const Eigen::Vector3d rate =
        0.5 * (samples[i - 1].angular_velocity + samples[i].angular_velocity);
    const Eigen::Quaterniond R = (state.T_odom_body.R * exp_so3(dt * rate)).normalized();
    const Eigen::Vector3d acceleration =
        kGravity +
        0.5 * (state.T_odom_body.R * samples[i - 1].specific_force + R * samples[i].specific_force);
    state.T_odom_body.p += dt * state.v_odom + 0.5 * dt * dt * acceleration;
    state.v_odom += dt * acceleration;
    state.T_odom_body.R = R;
  }
  const NavState truth = run.truth(at(10.0));
  EXPECT_LT((state.T_odom_body.p - truth.T_odom_body.p).norm(), 2e-5);
  EXPECT_LT((state.v_odom - truth.v_odom).norm(), 1e-5);
  EXPECT_LT(log_so3(state.T_odom_body.R.conjugate() * truth.T_odom_body.R).norm(), 1e-7);
}

TEST(SimulatedRun, WhiteNoiseHasTheDensityItClaims) {
  SimulatedRun::Config config;
  const SimulatedRun exact(config);
  config.imu_white_noise = true;
  const SimulatedRun noisy(config);
  const auto a = exact.imu(at(0.0), at(100.0));
  const auto b = noisy.imu(at(0.0), at(100.0));
  ASSERT_EQ(a.size(), b.size());
  double gyroscope = 0.0;
  double accelerometer = 0.0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double weight = 1.0 / (3.0 * static_cast<double>(a.size()));
    gyroscope += weight * (b[i].angular_velocity - a[i].angular_velocity).squaredNorm();
    accelerometer += weight * (b[i].specific_force - a[i].specific_force).squaredNorm();
    mean += 3.0 * weight * (b[i].specific_force - a[i].specific_force);
  }
  const double root_rate = std::sqrt(config.imu_rate_hz);
  EXPECT_NEAR(std::sqrt(gyroscope) / root_rate / exact.noise().gyroscope_noise_density, 1.0, 0.02);
  EXPECT_NEAR(
      std::sqrt(accelerometer) / root_rate / exact.noise().accelerometer_noise_density, 1.0, 0.02);
  EXPECT_LT(mean.norm(), 1e-3);  // sigma of each component is 2e-4
}

TEST(SimulatedRun, BiasWalksAsFarAsItClaims) {
  SimulatedRun::Config config;
  config.imu_bias_walk = true;
  double gyroscope = 0.0;
  double accelerometer = 0.0;
  constexpr int kRuns = 200;
  constexpr double kTime = 4.0;
  config.landmarks = 0;
  for (int i = 0; i < kRuns; ++i) {
    config.seed = static_cast<std::uint64_t>(i) + 1;
    const ImuBias bias = SimulatedRun(config).truth(at(kTime)).bias;
    gyroscope += bias.gyroscope.squaredNorm() / (3.0 * kRuns * kTime);
    accelerometer += bias.accelerometer.squaredNorm() / (3.0 * kRuns * kTime);
  }
  const ImuNoise noise = SimulatedRun(config).noise();
  EXPECT_NEAR(std::sqrt(gyroscope) / noise.gyroscope_random_walk, 1.0, 0.1);
  EXPECT_NEAR(std::sqrt(accelerometer) / noise.accelerometer_random_walk, 1.0, 0.1);
}

TEST(SimulatedRun, PixelNoiseAndOutliersAreAsConfigured) {
  SimulatedRun::Config config;
  config.pixel_sigma = 0.5;
  config.outlier_share = 0.2;
  const SimulatedRun run(config);
  double square = 0.0;
  int inliers = 0;
  int outliers = 0;
  for (int i = 0; i < 100; ++i) {
    const TrackedFrame frame = run.frame(i);
    for (const StereoObservation& seen : frame.observations) {
      const Eigen::Vector2d error = seen.left - expected_pixel(run, frame, seen.landmark).head<2>();
      if (error.cwiseAbs().maxCoeff() > 5.0 * config.pixel_sigma) {
        ++outliers;
        EXPECT_LT(error.cwiseAbs().maxCoeff(), 53.0);
      } else {
        ++inliers;
        square += error.squaredNorm();
      }
    }
  }
  EXPECT_NEAR(outliers / static_cast<double>(inliers + outliers), 0.2, 0.02);
  EXPECT_NEAR(std::sqrt(square / (2.0 * inliers)), 0.5, 0.02);
}

}  // namespace
}  // namespace fleetloc
