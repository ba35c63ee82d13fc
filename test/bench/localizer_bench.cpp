// What one localization costs, from the submap on: windows of 40 keyframes with about 80
// observations each, on one core. The first window of a session and the ones that follow it.
#include <benchmark/benchmark.h>

#include "test/unit/localizer/simulated_session.hpp"

namespace fleetloc {
namespace {

constexpr int kWindow = 40;

std::vector<Submap> submaps(int count) {
  const SimulatedSession robot({.seed = 5});
  std::vector<Submap> result;
  result.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) result.push_back(robot.submap(i));
  return result;
}

void following_submap(benchmark::State& state) {
  const SimulatedSession robot({.seed = 5});
  SessionLocalizer localizer(robot.session(), room_map(), localizer_config());
  int next = 0;
  for (; next < kWindow; ++next) localizer.add(robot.submap(next));
  localizer.localize();
  int localized = 0;
  while (state.KeepRunning()) {
    state.PauseTiming();
    const Submap submap = robot.submap(next++);
    state.ResumeTiming();
    localizer.add(submap);
    if (localizer.localize().status == LocalizationStatus::kLocalized) ++localized;
    if (state.range(0) != 0) benchmark::DoNotOptimize(localizer.correction());
  }
  state.counters["localized"] =
      static_cast<double>(localized) / static_cast<double>(state.iterations());
  state.counters["memory_bytes"] = static_cast<double>(localizer.memory_bytes());
}
BENCHMARK(following_submap)
    ->ArgName("correction")
    ->Arg(0)
    ->Arg(1)
    ->Unit(benchmark::kMillisecond)
    ->Iterations(100);

void first_window(benchmark::State& state) {
  const SimulatedSession robot({.seed = 5});
  const std::vector<Submap> window = submaps(kWindow);
  while (state.KeepRunning()) {
    SessionLocalizer localizer(robot.session(), room_map(), localizer_config());
    for (const Submap& submap : window) localizer.add(submap);
    benchmark::DoNotOptimize(localizer.localize());
  }
}
BENCHMARK(first_window)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace fleetloc
