#include "robot/inertial/preintegration.hpp"

#include <functional>
#include <vector>

#include <gmock/gmock.h>

#include "test/unit/inertial/inertial_fixtures.hpp"

namespace fleetloc {
namespace {

const ImuNoise kNoise{1.7e-4, 2e-5, 2e-3, 3e-3};

std::vector<ImuSample> sampled(double duration_s,
                               int intervals,
                               const std::function<ImuSample(double)>& reading) {
  std::vector<ImuSample> samples;
  for (int i = 0; i <= intervals; ++i) {
    const double t = duration_s * i / intervals;
    samples.push_back(reading(t));
    samples.back().stamp = at_second(t);
  }
  return samples;
}

// Constant rate about any axis is one rotation, however it is sampled.
TEST(Preintegration, TurnsExactlyAtAConstantRate) {
  const Eigen::Vector3d rate{0.7, -0.4, 1.1};
  const ImuBias bias{{0.1, 0.2, 0.3}, {0.0, 0.0, 0.0}};
  const auto samples = sampled(2.0, 37, [&](double) {
    return ImuSample{{}, rate + bias.gyroscope, Eigen::Vector3d::Zero()};
  });
  const Preintegration preintegration(samples, bias, kNoise);
  const auto deltas = preintegration.deltas(bias);
  EXPECT_LT(log_so3(deltas.R.conjugate() * exp_so3(2.0 * rate)).norm(), 1e-12);
  EXPECT_EQ(deltas.p.norm(), 0.0);
  EXPECT_EQ(deltas.v.norm(), 0.0);
  EXPECT_EQ(preintegration.duration(), Duration{2'000'000'000});
}

TEST(Preintegration, IsExactForConstantAccelerationWithoutRotation) {
  const Eigen::Vector3d force{0.3, -1.0, 9.0};
  const ImuBias bias{{0.0, 0.0, 0.0}, {0.2, 0.1, -0.1}};
  const auto samples = sampled(1.5, 11, [&](double) {
    return ImuSample{{}, Eigen::Vector3d::Zero(), force + bias.accelerometer};
  });
  const auto deltas = Preintegration(samples, bias, kNoise).deltas(bias);
  EXPECT_LT((deltas.v - 1.5 * force).norm(), 1e-12);
  EXPECT_LT((deltas.p - 0.5 * 1.5 * 1.5 * force).norm(), 1e-12);
}

// An acceleration that is constant in the frame of the start, seen from a turning body: the mean
// of both ends is taken after rotating them, so this is exact as well.
TEST(Preintegration, IsExactForConstantRateAndConstantAcceleration) {
  const Eigen::Vector3d rate{0.5, 1.0, -2.0};
  const Eigen::Vector3d force{0.3, -1.0, 9.8};
  const auto samples = sampled(1.0, 50, [&](double t) {
    return ImuSample{{}, rate, exp_so3(-t * rate) * force};
  });
  const auto deltas = Preintegration(samples, {}, kNoise).deltas({});
  EXPECT_LT(log_so3(deltas.R.conjugate() * exp_so3(rate)).norm(), 1e-12);
  EXPECT_LT((deltas.v - force).norm(), 1e-12);
  EXPECT_LT((deltas.p - 0.5 * force).norm(), 1e-12);
}

// A force that turns with the body: the closed form is by sine and cosine, the error of second
// order.
TEST(Preintegration, ConvergesToTheClosedFormOfACircle) {
  constexpr double kRate = 1.5;
  const Eigen::Vector3d v{2.0 * std::sin(kRate) / kRate, 2.0 * (1.0 - std::cos(kRate)) / kRate, 0};
  const Eigen::Vector3d p{2.0 * (1.0 - std::cos(kRate)) / (kRate * kRate),
                          2.0 * (kRate - std::sin(kRate)) / (kRate * kRate),
                          0.0};
  const auto error = [&](int intervals) {
    const auto samples = sampled(1.0, intervals, [&](double) {
      return ImuSample{{}, {0.0, 0.0, kRate}, {2.0, 0.0, 0.0}};
    });
    const auto deltas = Preintegration(samples, {}, kNoise).deltas({});
    return (deltas.v - v).norm() + (deltas.p - p).norm();
  };
  EXPECT_LT(error(200), 2e-5);
  EXPECT_NEAR(error(100) / error(200), 4.0, 0.1);
}

TEST(Preintegration, AgreesWithATenTimesFinerIntegration) {
  SimulatedRun::Config config = lively();
  const SimulatedRun coarse(config);
  config.imu_rate_hz *= 10.0;
  const SimulatedRun fine(config);
  const ImuBias& bias = config.initial_bias;
  for (const double start : {0.0, 3.0, 11.0}) {
    const Timestamp from = at_second(start);
    const Timestamp to = at_second(start + 0.5);
    const Preintegration a(coarse.imu(from, to), bias, kNoise);
    const Preintegration b(fine.imu(from, to), bias, kNoise);
    const Vector9d error = difference(a.deltas(bias), b.deltas(bias));
    EXPECT_LT(error.head<3>().norm(), 5e-6);
    EXPECT_LT(error.segment<3>(3).norm(), 1e-5);
    EXPECT_LT(error.tail<3>().norm(), 3e-5);
    const Matrix9d ratio = a.covariance() - b.covariance();
    EXPECT_LT(ratio.norm(), 1e-2 * b.covariance().norm());
  }
}

TEST(Preintegration, PredictsTheTruthOfASimulatedRun) {
  const SimulatedRun run(lively());
  for (const double start : {0.0, 5.0, 20.0}) {
    const Timestamp from = at_second(start);
    const Timestamp to = at_second(start + 10.0);
    const NavState begin = run.truth(from);
    const NavState truth = run.truth(to);
    const NavState end = Preintegration(run.imu(from, to), begin.bias, kNoise).predict(begin);
    EXPECT_LT((end.T_odom_body.p - truth.T_odom_body.p).norm(), 1e-3);
    EXPECT_LT((end.v_odom - truth.v_odom).norm(), 3e-4);
    EXPECT_LT(log_so3(end.T_odom_body.R.conjugate() * truth.T_odom_body.R).norm(), 1e-5);
    EXPECT_EQ(end.bias.gyroscope, begin.bias.gyroscope);
    RecordProperty("position_error_um_" + std::to_string(static_cast<int>(start)),
                   static_cast<int>(1e6 * (end.T_odom_body.p - truth.T_odom_body.p).norm()));
  }
}

TEST(Preintegration, BiasJacobianMatchesReintegration) {
  const SimulatedRun run(lively());
  const auto samples = run.imu(at_second(2.0), at_second(2.5));
  const ImuBias bias = lively().initial_bias;
  const Preintegration preintegration(samples, bias, kNoise);
  const auto deltas = preintegration.deltas(bias);
  constexpr double kStep = 1e-5;
  Matrix96d numeric;
  for (int i = 0; i < 6; ++i) {
    const Vector6d step = kStep * Vector6d::Unit(i);
    const ImuBias above = plus(bias, step);
    const ImuBias below = plus(bias, Vector6d(-step));
    numeric.col(i) = (difference(deltas, Preintegration(samples, above, kNoise).deltas(above)) -
                      difference(deltas, Preintegration(samples, below, kNoise).deltas(below))) /
                     (2.0 * kStep);
  }
  EXPECT_LT((numeric - preintegration.bias_jacobian()).cwiseAbs().maxCoeff(), 1e-8);
}

TEST(Preintegration, CorrectionForASmallBiasChangeIsOfSecondOrder) {
  const SimulatedRun run(lively());
  const auto samples = run.imu(at_second(2.0), at_second(2.5));
  const ImuBias bias = lively().initial_bias;
  const Preintegration preintegration(samples, bias, kNoise);
  Vector6d change;
  change << 0.01, -0.02, 0.02, 0.1, -0.1, 0.1;
  const auto error = [&](double scale) {
    const ImuBias other = plus(bias, Vector6d(scale * change));
    return difference(preintegration.deltas(other),
                      preintegration.relinearized(other).deltas(other))
        .norm();
  };
  EXPECT_LT(error(1.0), 1e-3);
  EXPECT_NEAR(error(1.0) / error(0.5), 4.0, 0.2);
}

TEST(Preintegration, RelinearizedEqualsFreshBitForBit) {
  const SimulatedRun run(lively());
  const auto samples = run.imu(at_second(1.0), at_second(1.3));
  const ImuBias other{{0.02, 0.01, 0.0}, {0.3, 0.2, 0.1}};
  const Preintegration fresh(samples, other, kNoise);
  const Preintegration again = Preintegration(samples, {}, kNoise).relinearized(other);
  EXPECT_EQ(difference(fresh.deltas(other), again.deltas(other)).norm(), 0.0);
  EXPECT_EQ(fresh.covariance(), again.covariance());
  EXPECT_EQ(fresh.bias_walk_covariance(), again.bias_walk_covariance());
  EXPECT_EQ(fresh.bias_jacobian(), again.bias_jacobian());
  EXPECT_EQ(again.bias().accelerometer, other.accelerometer);
}

}  // namespace
}  // namespace fleetloc
