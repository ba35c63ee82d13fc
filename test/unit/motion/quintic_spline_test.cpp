#include "deploy/sim/motion/quintic_spline.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include <gmock/gmock.h>

#include "shared/core/counter_random.hpp"

namespace fleetloc {
namespace {

SplineSamples sampled(const std::vector<double>& times_s, double (*function)(double)) {
  SplineSamples samples{.times_s = times_s,
                        .weights = std::vector<double>(times_s.size(), 1.0),
                        .values = Eigen::MatrixXd(static_cast<Eigen::Index>(times_s.size()), 1)};
  Eigen::Index row = 0;
  for (const double time_s : times_s) samples.values(row++, 0) = function(time_s);
  return samples;
}

std::vector<double> steps(int count, double step_s) {
  std::vector<double> times_s(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < times_s.size(); ++i) times_s[i] = static_cast<double>(i) * step_s;
  return times_s;
}

std::vector<double> constant(const SplineGrid& grid, double penalty) {
  std::vector<double> penalties(static_cast<std::size_t>(grid.intervals), penalty);
  return penalties;
}

TEST(QuinticSpline, BasisSumsToOneAndItsDerivativesToZero) {
  for (const double u : {0.0, 0.2, 0.5, 0.99, 1.0}) {
    const auto basis = quintic_basis(u);
    EXPECT_NEAR(basis.col(0).sum(), 1.0, 1e-13);
    EXPECT_NEAR(basis.col(1).sum(), 0.0, 1e-13);
    EXPECT_NEAR(basis.col(2).sum(), 0.0, 1e-12);
    EXPECT_GE(basis.col(0).minCoeff(), -1e-15);
  }
}

TEST(QuinticSpline, JoinsItsIntervalsWithContinuousDerivatives) {
  const auto end = quintic_basis(1.0);
  const auto begin = quintic_basis(0.0);
  for (int i = 0; i + 1 < kQuinticSupport; ++i) {
    EXPECT_LT((end.row(i + 1) - begin.row(i)).norm(), 1e-12);
  }
  EXPECT_LT(end.row(0).norm(), 1e-12);
}

TEST(QuinticSpline, IsExactForAPolynomialThatThePenaltyLeavesAlone) {
  const SplineGrid grid = grid_over(10.0, 0.3);
  const auto parabola = [](double t) { return 1e5 + 3.0 * t - 0.7 * t * t; };
  const auto samples = sampled(steps(40, 0.25), parabola);
  const auto fit = fit_quintic_spline(grid, samples, constant(grid, 10.0));
  const std::vector<double> times{0.0, 0.1, 4.56, 9.9};
  const auto values = spline_values(grid, fit, times);
  for (std::size_t i = 0; i < times.size(); ++i) {
    EXPECT_NEAR(values(static_cast<Eigen::Index>(i), 0), parabola(times[i]), 1e-6);
  }
}

TEST(QuinticSpline, HalvesTheAmplitudeAtItsCutoff) {
  constexpr double kStep = 0.05;
  const SplineGrid grid = grid_over(60.0, 0.1);
  const auto sine = [](double t) { return std::sin(2.0 * std::numbers::pi * 0.8 * t); };
  const auto samples = sampled(steps(1201, kStep), sine);
  const auto amplitude = [&](double cutoff_hz) {
    const auto fit =
        fit_quintic_spline(grid, samples, constant(grid, penalty_for_cutoff(cutoff_hz, kStep)));
    const std::vector<double> middle = steps(600, 0.1);
    return spline_values(grid, fit, middle).middleRows(200, 200).cwiseAbs().maxCoeff();
  };
  EXPECT_NEAR(amplitude(0.8), 0.5, 0.02);
  EXPECT_GT(amplitude(1.6), 0.97);
  EXPECT_LT(amplitude(0.4), 0.03);
}

TEST(QuinticSpline, TakesRepeatedAndDisorderedTimes) {
  const SplineGrid grid = grid_over(2.0, 0.2);
  const auto line = [](double t) { return 2.0 * t; };
  const auto samples = sampled({2.0, 0.0, 0.5, 0.5, 1.5, 1.0}, line);
  const auto fit = fit_quintic_spline(grid, samples, constant(grid, 1e-3));
  EXPECT_NEAR(spline_values(grid, fit, std::vector{1.23})(0, 0), 2.46, 1e-9);
}

TEST(QuinticSpline, RefusesWhatDoesNotDetermineIt) {
  const SplineGrid grid = grid_over(2.0, 0.2);
  const auto samples = sampled({0.0, 1.0, 1.0}, [](double t) { return t; });
  EXPECT_THROW(static_cast<void>(fit_quintic_spline(grid, samples, constant(grid, 1.0))),
               std::invalid_argument);
}

}  // namespace
}  // namespace fleetloc
