#include <array>
#include <cmath>

#include <benchmark/benchmark.h>

#include "deploy/sim/room/simulated_run.hpp"
#include "robot/inertial/imu_factor.hpp"

namespace fleetloc {
namespace {

Timestamp at(double time_s) {
  return Timestamp{Duration{std::llround(time_s * 1e9)}};
}

SimulatedRun without_landmarks() {
  SimulatedRun::Config config;
  config.landmarks = 0;
  return SimulatedRun(config);
}

// A frame at 50 Hz, at 20 Hz, and half a second; samples per second.
void preintegrate(benchmark::State& state) {
  const SimulatedRun run = without_landmarks();
  const auto samples = run.imu(at(1.0), at(1.0 + 0.005 * static_cast<double>(state.range(0))));
  while (state.KeepRunning()) {
    benchmark::DoNotOptimize(Preintegration(samples, {}, run.noise()));
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(preintegrate)->Arg(4)->Arg(10)->Arg(100);

// Residuals and all four Jacobians.
void evaluate_imu_factor(benchmark::State& state) {
  const SimulatedRun run = without_landmarks();
  const NavState first = run.truth(at(1.0));
  const NavState second = run.truth(at(1.3));
  const ImuFactor factor(Preintegration(run.imu(at(1.0), at(1.3)), {}, run.noise()));
  const auto pose_1 = to_parameters(first.T_odom_body);
  const auto speed_1 = to_speed_bias(first);
  const auto pose_2 = to_parameters(second.T_odom_body);
  const auto speed_2 = to_speed_bias(second);
  const std::array parameters{pose_1.data(), speed_1.data(), pose_2.data(), speed_2.data()};
  std::array<double, 15> residuals{};
  std::array<std::array<double, 135>, 4> J{};  // 15 x 9 at most
  std::array jacobians{J[0].data(), J[1].data(), J[2].data(), J[3].data()};
  while (state.KeepRunning()) {
    benchmark::DoNotOptimize(
        factor.Evaluate(parameters.data(), residuals.data(), jacobians.data()));
    benchmark::ClobberMemory();
  }
}
BENCHMARK(evaluate_imu_factor);

// Whitening, once per relinearization.
void make_imu_factor(benchmark::State& state) {
  const SimulatedRun run = without_landmarks();
  const Preintegration preintegration(run.imu(at(1.0), at(1.3)), {}, run.noise());
  while (state.KeepRunning()) {
    benchmark::DoNotOptimize(ImuFactor(preintegration));
  }
}
BENCHMARK(make_imu_factor);

}  // namespace
}  // namespace fleetloc
