// sensors_bench: what images of the campus cost, on one thread; the usual options of Google
// Benchmark apply. sensors_bench --pictures=FOLDER: images of each season, and what is in them.

#include <chrono>
#include <cstdio>
#include <string>

#include <benchmark/benchmark.h>
#include <opencv2/core/utility.hpp>

#include "deploy/sim/sensors/landmark_survey.hpp"
#include "robot/dataset/image_file.hpp"
#include "shared/core/cpu_time.hpp"
#include "test/unit/sensors/campus_cameras.hpp"
#include "test/unit/world/campus.hpp"

namespace fleetloc {
namespace {

void print_sessions(const std::string& folder) {
  const WorldConfig world = campus();
  const auto route = eight();
  const Duration begin = thread_cpu_time();
  const Scene scene = build_scene(world.scene, route, 1);
  const Duration built = thread_cpu_time();
  const SeasonScene survey = season_of(world, scene, world.survey);
  const Duration applied = thread_cpu_time();
  std::printf("route %.0f m: %zu triangles, scene %.2f s, season %.2f s\n",
              static_cast<double>(scene.route->length_m()),
              survey.triangles(),
              to_seconds(built - begin),
              to_seconds(applied - built));
  const StereoCalibration cameras = campus_cameras();
  for (const SeasonConfig& config : world.seasons) {
    const SeasonScene season = season_of(world, scene, config.name);
    std::vector<VisibleLandmark> all;
    std::size_t least = 1000;
    for (int i = 0; i < 24; ++i) {
      StereoRenderer renderer(cameras, season, camera_settings(2), 1);
      const Pose T_map_body = T_map_body_on_eight(i / 24.0);
      const StereoFrame frame =
          renderer.render({.stamp = {}, .time_s = 1.0 * i, .frame = 0},
                          [i](double) { return T_map_body_on_eight(i / 24.0); });
      const auto landmarks = visible_landmarks(frame.left,
                                               season.at(1.0 * i).caster,
                                               cameras.cam0,
                                               T_map_body * cameras.T_body_cam0,
                                               400);
      all.insert(all.end(), landmarks.begin(), landmarks.end());
      least = std::min(least, landmarks.size());
      if (!folder.empty() && i % 6 == 1) {
        write_image(folder + "/" + config.name + std::to_string(i) + ".png", frame.left, 90);
      }
    }
    std::printf("%-8s unmapped %.2f  landmarks per image %.0f, at least %zu\n",
                config.name.c_str(),
                unmapped_share(all, survey.fixed()),
                static_cast<double>(all.size()) / 24.0,
                least);
  }
}

void stereo_pair(benchmark::State& state, const std::string& name) {
  const WorldConfig world = campus();
  const Scene scene = build_scene(world.scene, eight(), 1);
  const SeasonScene season = season_of(world, scene, name);
  StereoRenderer renderer(campus_cameras(), season, camera_settings(1), 1);
  std::uint64_t frame = 0;
  while (state.KeepRunning()) {
    const double time_s = 0.05 * static_cast<double>(frame);
    const double place = 0.017 * static_cast<double>(frame);
    benchmark::DoNotOptimize(
        renderer.render({.stamp = {}, .time_s = time_s, .frame = frame++},
                        [place](double) { return T_map_body_on_eight(place); }));
  }
}
BENCHMARK_CAPTURE(stereo_pair, summer, "summer")->Unit(benchmark::kMillisecond)->Iterations(60);
BENCHMARK_CAPTURE(stereo_pair, winter, "winter")->Unit(benchmark::kMillisecond)->Iterations(60);

}  // namespace
}  // namespace fleetloc

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  const std::string option = argc == 2 ? argv[1] : "";
  const std::string prefix = "--pictures=";
  if (argc > 2 || (argc == 2 && !option.starts_with(prefix))) {
    std::fprintf(stderr, "usage: sensors_bench [--pictures=FOLDER]\n");
    return 2;
  }
  cv::setNumThreads(1);
  if (argc == 2) {
    fleetloc::print_sessions(option.substr(prefix.size()));
  } else {
    benchmark::RunSpecifiedBenchmarks();
  }
  return 0;
}
