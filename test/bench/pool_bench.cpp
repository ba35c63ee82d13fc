// How long it takes to choose whose submaps are localized next, by the number of robots that wait.
#include <chrono>
#include <memory>
#include <string>

#include <benchmark/benchmark.h>

#include "cloud/laser_map/build_map.hpp"
#include "cloud/pool/localizer_pool.hpp"
#include "deploy/config/default_config.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/wire/session_codec.hpp"
#include "shared/wire/submap_codec.hpp"

namespace fleetloc {
namespace {

/// Robots with a session each; localizations themselves are left out.
class WaitingRobots {
 public:
  explicit WaitingRobots(int count) {
    for (int i = 0; i < count; ++i) {
      RobotSession session;
      session.robot = "robot_" + std::to_string(i);
      session.session = SessionNumber{1};
      session.localizer = "localizer";
      session.incarnation = Incarnation{3};
      session.stereo = {
          .focal_px = 450.0, .center_px = {1024.0, 1024.0}, .baseline_m = 0.1, .T_body_cam0 = {}};
      pool_.receive({Topic::kSession, encode(session)}, now_);
      send(session.robot);
    }
  }

  /// The robot of the next job, which is done at once, and then waits again. @return time of taking
  double take() {
    const auto begin = std::chrono::steady_clock::now();
    auto job = pool_.take_job(now_);
    const std::chrono::duration<double> taking = std::chrono::steady_clock::now() - begin;
    now_ += std::chrono::microseconds(10);
    pool_.finish(*job, LocalizationResult{}, 1.0, now_);
    send(job->robot);
    return taking.count();
  }

 private:
  void send(const RobotId& robot) {
    Submap submap;
    submap.robot = robot;
    submap.session = SessionNumber{1};
    submap.incarnation = Incarnation{3};
    submap.number = SampleNumber{number_++};
    submap.keyframes.push_back({.id = KeyframeId{1},
                                .revision = Revision{1},
                                .stamp = {},
                                .T_odom_body = {},
                                .tilt_sigma = 0.01,
                                .observations = {}});
    pool_.receive({Topic::kSubmap, encode(submap)}, now_);
  }

  static ConfigReader defaults() { return ConfigReader::from_string(default_config("everything")); }

  Timestamp now_;
  std::uint32_t number_ = 0;
  LocalizerPool pool_{
      "localizer",
      Incarnation{3},
      std::make_shared<const LaserMap>(build_map({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}},
                                                 "map",
                                                 read_map_config(defaults().section("map")))),
      read_localizer_pool_config(defaults())};
};

void take_job(benchmark::State& state) {
  WaitingRobots robots(static_cast<int>(state.range(0)));
  while (state.KeepRunning()) state.SetIterationTime(robots.take());
}
BENCHMARK(take_job)->Arg(10)->Arg(100)->Arg(1000)->UseManualTime()->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace fleetloc
