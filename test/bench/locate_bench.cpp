// What it costs to find a robot in a map of 400 m x 300 m of which it knows nothing: the pyramid,
// once for each map, and a search with 150 landmarks.
#include <benchmark/benchmark.h>

#include "cloud/locate/place_search.hpp"
#include "shared/geometry/so3.hpp"
#include "test/unit/locate/street_map.hpp"

namespace fleetloc {
namespace {

const StreetMap& street() {
  static const StreetMap street(1, 1000, 400.0, 300.0);
  return street;
}

void pyramid(benchmark::State& state) {
  const LaserMap map = street().map();
  for (auto _ : state) {
    const MapPyramid pyramid(map, pyramid_config());
    benchmark::DoNotOptimize(pyramid);
    state.counters["bytes"] = static_cast<double>(pyramid.bytes());
  }
  state.counters["bytes_of_points"] = static_cast<double>(map.size() * sizeof(MapPoint));
}
BENCHMARK(pyramid)->Unit(benchmark::kMillisecond);

void search(benchmark::State& state) {
  const LaserMap map = street().map();
  const MapPyramid pyramid(map, pyramid_config());
  const Pose truth{exp_so3({0.0, 0.0, 1.0}), {210.0, 130.0, 1.2}};
  std::vector<SeenLandmark> landmarks;
  for (const Eigen::Vector3d& p_map : street().seen_from(truth.p, 25.0, 150)) {
    landmarks.push_back({.p = inverse(truth) * p_map});
  }
  const PlaceSearch::Config config{
      .max_places = 3, .min_share = 0.85, .same_m = 2.0, .same_rad = 0.3};
  for (auto _ : state) {
    PlaceSearch search(pyramid, landmarks, {map.info().min, map.info().max}, config);
    search.advance(1'000'000'000);
    state.counters["evaluations"] = static_cast<double>(search.evaluations());
    state.counters["error_m"] = (search.places().front().T_map_seen.p - truth.p).norm();
  }
}
BENCHMARK(search)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace fleetloc
