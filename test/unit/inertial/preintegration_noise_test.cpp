#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <gmock/gmock.h>

#include "robot/inertial/imu_factor.hpp"
#include "test/unit/inertial/inertial_fixtures.hpp"

namespace fleetloc {
namespace {

constexpr int kRuns = 3000;

// Samples of a run without noise, at uneven stamps.
std::vector<ImuSample> uneven(const SimulatedRun& exact) {
  std::vector<ImuSample> samples = exact.imu(at_second(3.0), at_second(3.6));
  std::vector<ImuSample> kept;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (i % 7 != 3 && i % 11 != 5) {
      kept.push_back(samples[i]);
    }
  }
  return kept;
}

Matrix15d monte_carlo(const std::vector<ImuSample>& exact,
                      const ImuNoise& noise,
                      const ImuBias& bias) {
  const Preintegration reference(exact, bias, noise);
  Matrix15d covariance = Matrix15d::Zero();
  for (int run = 0; run < kRuns; ++run) {
    const CounterRandom random(7, static_cast<std::uint64_t>(run));
    std::vector<ImuSample> samples = exact;
    ImuBias walked;  // since the first sample
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double before = i > 0 ? to_seconds(samples[i].stamp - samples[i - 1].stamp) : 0.0;
      const double after =
          i + 1 < samples.size() ? to_seconds(samples[i + 1].stamp - samples[i].stamp) : before;
      const double root_walk = std::sqrt(before);
      // A sample stands for half the time on either side.
      const double root_white = 1.0 / std::sqrt(0.5 * ((i > 0 ? before : after) + after));
      walked.gyroscope += noise.gyroscope_random_walk * root_walk * random.normal3(4 * i);
      walked.accelerometer +=
          noise.accelerometer_random_walk * root_walk * random.normal3(4 * i + 1);
      samples[i].angular_velocity +=
          walked.gyroscope + noise.gyroscope_noise_density * root_white * random.normal3(4 * i + 2);
      samples[i].specific_force += walked.accelerometer + noise.accelerometer_noise_density *
                                                              root_white *
                                                              random.normal3(4 * i + 3);
    }
    Vector15d error;  // what is true minus what was measured
    error << difference(Preintegration(samples, bias, noise).deltas(bias), reference.deltas(bias)),
        walked.gyroscope, walked.accelerometer;
    covariance += error * error.transpose() / kRuns;
  }
  return covariance;
}

// Whitened by the covariance claimed, the one found must be the identity.
void expect_same(const Matrix15d& found, const Matrix15d& claimed) {
  const Eigen::LLT<Matrix15d> cholesky(claimed);
  ASSERT_EQ(cholesky.info(), Eigen::Success);
  const Matrix15d half = cholesky.matrixL().solve(found);
  const Matrix15d white = cholesky.matrixL().solve(half.transpose());
  const Matrix15d error = white - Matrix15d::Identity();
  // Of 3000 runs a variance has a relative sigma of 2.6 %, a correlation one of 1.8 %.
  EXPECT_LT(error.cwiseAbs().maxCoeff(), 0.1) << white;
  EXPECT_NEAR(white.trace() / 15.0, 1.0, 0.02);
}

TEST(PreintegrationNoise, CovarianceMatchesMonteCarloAtUnevenStamps) {
  const SimulatedRun run(lively());
  const ImuBias bias = lively().initial_bias;
  const auto samples = uneven(run);
  const Preintegration preintegration(samples, bias, run.noise());
  expect_same(monte_carlo(samples, run.noise(), bias), imu_error_covariance(preintegration));
}

// With a walk so strong that it rules, its part in the deltas and its correlation are seen.
TEST(PreintegrationNoise, CovarianceHoldsForAStrongBiasWalk) {
  const SimulatedRun run(lively());
  const ImuBias bias = lively().initial_bias;
  const ImuNoise noise{1.7e-4, 3e-3, 2e-3, 3e-2};
  const auto samples = uneven(run);
  const Preintegration preintegration(samples, bias, noise);
  expect_same(monte_carlo(samples, noise, bias), imu_error_covariance(preintegration));
}

// A standstill before the samples is the same as a wider bias before them.
TEST(PreintegrationNoise, BiasesWalkOnThroughAStandstill) {
  const SimulatedRun run(lively());
  const auto samples = uneven(run);
  const Preintegration driven(samples, {}, run.noise());
  const Preintegration stood(samples, {}, run.noise(), std::chrono::hours(1));
  EXPECT_EQ(stood.deltas({}).p, driven.deltas({}).p);
  Vector6d walk;
  walk << Eigen::Vector3d::Constant(3600.0 * std::pow(run.noise().gyroscope_random_walk, 2)),
      Eigen::Vector3d::Constant(3600.0 * std::pow(run.noise().accelerometer_random_walk, 2));
  Eigen::Matrix<double, 15, 6> B;
  B << driven.bias_jacobian(), Matrix6d::Identity();
  const Matrix15d expected = imu_error_covariance(driven) + B * walk.asDiagonal() * B.transpose();
  EXPECT_TRUE(imu_error_covariance(stood).isApprox(expected, 1e-9));
}

// Continuous white noise does not know how often it is sampled.
TEST(PreintegrationNoise, CovarianceHardlyDependsOnTheRate) {
  SimulatedRun::Config config = lively();
  const auto covariance = [&](double rate_hz) {
    config.imu_rate_hz = rate_hz;
    const SimulatedRun run(config);
    const auto samples = run.imu(at_second(1.0), at_second(1.5));
    return imu_error_covariance(Preintegration(samples, config.initial_bias, run.noise()));
  };
  const Matrix15d fast = covariance(1000.0);
  const Matrix15d slow = covariance(100.0);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix15d> solver(slow, fast);
  EXPECT_NEAR(solver.eigenvalues().minCoeff(), 1.0, 0.02);
  EXPECT_NEAR(solver.eigenvalues().maxCoeff(), 1.0, 0.02);
}

TEST(PreintegrationNoise, ASingleStepHasARegularCovariance) {
  const SimulatedRun run(lively());
  const auto samples = run.imu(at_second(1.0), at_second(1.005));
  ASSERT_EQ(samples.size(), 2U);
  const Preintegration preintegration(samples, {}, run.noise());
  const Matrix15d covariance = imu_error_covariance(preintegration);
  const Vector15d scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Matrix15d correlation = scale.asDiagonal() * covariance * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix15d> solver(correlation);
  EXPECT_GT(solver.eigenvalues().minCoeff(), 0.01);
  // Continuous white noise: p varies by s^2 dt^3 / 3.
  const double variance = std::pow(run.noise().accelerometer_noise_density, 2) * 1.25e-7 / 3.0;
  EXPECT_NEAR(covariance(4, 4) / variance, 1.0, 0.05);
}

// The factor's own statistic over simulated measurements, bias walk included.
TEST(PreintegrationNoise, WhitenedErrorOfTheTruthHasFifteenDegreesOfFreedom) {
  SimulatedRun::Config config = lively();
  config.imu_white_noise = true;
  config.imu_bias_walk = true;
  double mean = 0.0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    config.seed = seed;
    const SimulatedRun run(config);
    for (int half_second = 0; half_second < 40; ++half_second) {
      const double start = 0.5 * half_second;
      const Timestamp from = at_second(start);
      const Timestamp to = at_second(start + 0.5);
      const NavState first = run.truth(from);
      const NavState second = run.truth(to);
      const ImuFactor factor(Preintegration(run.imu(from, to), first.bias, run.noise()));
      const auto pose_1 = to_parameters(first.T_odom_body);
      const auto speed_1 = to_speed_bias(first);
      const auto pose_2 = to_parameters(second.T_odom_body);
      const auto speed_2 = to_speed_bias(second);
      const std::array blocks{pose_1.data(), speed_1.data(), pose_2.data(), speed_2.data()};
      Vector15d residual;
      factor.Evaluate(blocks.data(), residual.data(), nullptr);
      mean += residual.squaredNorm();
      ++count;
    }
  }
  mean /= count;
  // 400 samples of chi-square: sigma of the mean 0.27.
  EXPECT_NEAR(mean, 15.0, 0.9);
  RecordProperty("chi_square_milli", static_cast<int>(1000.0 * mean));
}

}  // namespace
}  // namespace fleetloc
