// What one keyframe and one frame cost: windows of ten keyframes over a simulated flight with the
// default configuration, 150 features a frame.
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "deploy/config/default_config.hpp"
#include "deploy/sim/room/simulated_run.hpp"
#include "robot/vio/vio_config.hpp"

namespace fleetloc {
namespace {

constexpr int kKeyframeFrames = 6;
constexpr int kKeyframes = 40;

SimulatedRun::Config noisy() {
  SimulatedRun::Config config;
  config.imu_white_noise = true;
  config.pixel_sigma = 0.5;
  return config;
}

struct Flight {
  SimulatedRun run{noisy()};
  VioConfig config =
      read_vio_config(ConfigReader::from_string(default_config("robot")).section("vio"));
  ImuBuffer imu;
  std::vector<KeyframeInput> keyframes;

  Flight() {
    const int last = kKeyframes * kKeyframeFrames;
    for (const ImuSample& sample : run.imu(run.frame_stamp(0), run.frame_stamp(last))) {
      imu.add(sample);
    }
    for (int i = 0; i < kKeyframes; ++i) {
      const int frame = i * kKeyframeFrames;
      KeyframeInput input{KeyframeId{static_cast<std::uint32_t>(i)}, run.frame(frame), {}};
      if (i > 0) {
        input.imu = imu.between(run.frame_stamp(frame - kKeyframeFrames), input.frame.stamp);
      }
      keyframes.push_back(std::move(input));
    }
  }

  // The first ten keyframes, with true states.
  SlidingWindow window() const {
    Initialization start;
    for (std::size_t i = 0; i < 10; ++i) {
      start.keyframes.push_back(keyframes[i]);
      start.states.push_back(run.truth(keyframes[i].frame.stamp));
    }
    return {run.stereo(), run.noise(), config.window, start};
  }
};

void add_keyframe(benchmark::State& state) {
  const Flight flight;
  SlidingWindow window = flight.window();
  std::size_t next = 10;
  double iterations = 0.0;
  double observations = 0.0;
  while (state.KeepRunning()) {
    if (next == flight.keyframes.size()) {
      state.PauseTiming();
      window = flight.window();
      next = 10;
      state.ResumeTiming();
    }
    const WindowEstimate estimate = window.add(flight.keyframes[next++]);
    iterations += estimate.diagnostics.iterations;
    observations += estimate.diagnostics.observations;
  }
  state.counters["iterations"] = benchmark::Counter(iterations, benchmark::Counter::kAvgIterations);
  state.counters["observations"] =
      benchmark::Counter(observations, benchmark::Counter::kAvgIterations);
}
BENCHMARK(add_keyframe)->Unit(benchmark::kMillisecond);

void estimate_frame(benchmark::State& state) {
  const Flight flight;
  FrameEstimator estimator(flight.run.stereo(), flight.run.noise(), flight.config.frame_estimator);
  estimator.update(std::make_shared<WindowEstimate>(flight.window().estimate()));
  const TrackedFrame frame =
      flight.run.frame(9 * kKeyframeFrames + static_cast<int>(state.range(0)));
  while (state.KeepRunning()) {
    benchmark::DoNotOptimize(estimator.estimate(frame, flight.imu));
  }
}
BENCHMARK(estimate_frame)->Arg(1)->Arg(8)->Unit(benchmark::kMicrosecond);

void initialize(benchmark::State& state) {
  const Flight flight;
  while (state.KeepRunning()) {
    Initializer initializer(flight.run.stereo(), flight.run.noise(), flight.config.initializer);
    expected<Initialization, NotInitialized> result = unexpected(NotInitialized::kCollecting);
    for (int i = 0; i < 60 && !result.has_value(); ++i) {
      const Timestamp stamp = flight.run.frame_stamp(i);
      result = initializer.add(flight.run.frame(i),
                               i == 0 ? std::vector<ImuSample>{}
                                      : flight.imu.between(flight.run.frame_stamp(i - 1), stamp));
    }
    benchmark::DoNotOptimize(result);
  }
}
BENCHMARK(initialize)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace fleetloc
