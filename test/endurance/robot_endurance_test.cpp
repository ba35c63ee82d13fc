// A robot that runs for long: nothing in it may grow with time. FLEETLOC_ENDURANCE_FRAMES sets how
// long; test/endurance.sh runs it for hours.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <vector>

#include <gtest/gtest.h>
#include <malloc.h>
#include <unistd.h>

#include "cloud/laser_map/build_map.hpp"
#include "deploy/replay/localizer_decorator.hpp"
#include "deploy/replay/simulated_back_end.hpp"
#include "deploy/replay/simulated_cloud.hpp"
#include "robot/cloud_client/cloud_client.hpp"
#include "robot/runtime/robot_runtime.hpp"
#include "shared/link/memory_network.hpp"
#include "test/looped_flight.hpp"
#include "test/truthful_localizer.hpp"

namespace fleetloc {
namespace {

constexpr std::size_t kShares = 10;    // of the run, in which memory is compared
constexpr std::size_t kWarmUp = 1500;  // frames until all windows are full, which are left out

std::size_t frame_count(std::size_t otherwise) {
  const char* frames = std::getenv("FLEETLOC_ENDURANCE_FRAMES");
  return frames == nullptr ? otherwise : std::stoul(frames);
}

double resident_mb() {
  std::ifstream statm("/proc/self/statm");
  double total_pages = 0.0;
  double resident_pages = 0.0;
  statm >> total_pages >> resident_pages;
  return resident_pages * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

double heap_in_use_mb() {
  return static_cast<double>(mallinfo2().uordblks) / 1e6;
}

/// Memory in each share of the run, and how good the robot's poses were.
class Watch final : public RobotSink {
 public:
  explicit Watch(const LoopedFlight& flight) : flight_(flight) {}

  void add(const RobotOutput& output) override {
    for (const FrameOutput& frame : output.frames) {
      note_memory();
      if (frame.pose.quality != Quality::kLocalized) continue;
      ++localized;
      const Pose truth = flight_.truth(frame.stamp);
      worst_m = std::max(worst_m, (frame.pose.T_map_body->p - truth.p).norm());
    }
  }

  std::array<double, kShares> heap_mb{};  // at most, as the next
  std::array<double, kShares> resident{};
  std::size_t localized = 0;
  double worst_m = 0.0;

 private:
  void note_memory() {
    if (frames_++ < kWarmUp) return;
    const std::size_t share =
        kShares * (frames_ - kWarmUp - 1) / (*flight_.frame_count() - kWarmUp);
    heap_mb[share] = std::max(heap_mb[share], heap_in_use_mb());
    resident[share] = std::max(resident[share], resident_mb());
  }

  const LoopedFlight& flight_;
  std::size_t frames_ = 0;
};

/// Memory that is freed stays with the process: what is resident is the most that was ever needed,
/// not where in a burst it was asked for.
void keep_freed_memory() {
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
  mallopt(M_MMAP_THRESHOLD, 1 << 30);
}

/// The robot's client, and the localizer that it talks to, in simulated time.
class LocalizerInProcess final : public LocalizerDecorator {
 public:
  LocalizerInProcess(CloudClient& client, SimulatedCloud& cloud)
      : LocalizerDecorator(client), cloud_(cloud) {}

  void update(Timestamp now, Quality quality) override {
    cloud_.advance(now);
    LocalizerDecorator::update(now, quality);
  }

 private:
  SimulatedCloud& cloud_;
};

std::shared_ptr<const LaserMap> map_of(const SimulatedRun& run) {
  std::vector<Eigen::Vector3f> points;
  for (const Eigen::Vector3d& p : run.surface_points(0.05)) points.push_back(p.cast<float>());
  return std::make_shared<const LaserMap>(
      build_map(points, "map", read_map_config(defaults().section("map"))));
}

/// @param unlocalized  frames at the start, at most
void expect_flat_memory(LoopedFlight& flight, MapLocalizer& localizer, std::size_t unlocalized) {
  const std::size_t frames = *flight.frame_count();
  const ConfigReader config = defaults();
  SimulatedBackEnd back_end(
      KeyframeWorker(
          flight.run().stereo(), flight.run().noise(), read_keyframe_worker_config(config), {}),
      std::chrono::milliseconds(50));
  RobotPipeline robot({.id = "robot",
                       .calibration = ideal_cameras(flight.run().stereo()),
                       .imu_noise = flight.run().noise(),
                       .T_map_body = flight.truth(Timestamp{})},
                      read_robot_pipeline_config(config),
                      back_end,
                      &localizer);
  Watch watch(flight);
  RobotRuntime("robot", flight, robot, {watch}).run({});

  for (std::size_t i = 0; i < kShares; ++i) {
    std::cout << "to " << 100 * (i + 1) / kShares << " %: heap " << watch.heap_mb[i]
              << " MB in use, resident " << watch.resident[i] << " MB\n";
  }
  std::cout << watch.localized << " of " << frames << " frames localized, worst error "
            << watch.worst_m << " m, " << robot.odometry().statistics().resets << " resets\n";
  EXPECT_LE(*std::ranges::max_element(watch.heap_mb), 1.02 * watch.heap_mb.front());
  EXPECT_LE(*std::ranges::max_element(watch.resident), 1.02 * watch.resident.front());
  EXPECT_GT(watch.localized, frames - unlocalized);
  EXPECT_LT(watch.worst_m, 0.15);
}

TEST(RobotEndurance, NeedsNoMoreMemoryAfterManyFramesThanAfterATenthOfThem) {
  keep_freed_memory();
  LoopedFlight flight(frame_count(20'000));
  TruthfulLocalizer localizer([&](Timestamp stamp) { return flight.truth(stamp); });
  expect_flat_memory(flight, localizer, 100);
}

TEST(RobotEndurance, NeedsNoMoreMemoryWithALocalizerInTheSameProcess) {
  keep_freed_memory();
  LoopedFlight flight(frame_count(6'000));
  MemoryNetwork network{LinkConfig{}};
  const auto robot_end = network.join_robot("robot");
  const auto cloud_end = network.join_cloud("localizer");
  SimulatedCloud cloud(LocalizerPool("localizer",
                                     Incarnation{1},
                                     map_of(flight.run()),
                                     read_localizer_pool_config(defaults())),
                       *cloud_end,
                       std::chrono::milliseconds(50),
                       {});
  CloudClient client("robot", *robot_end, read_cloud_client_config(defaults().section("client")));
  LocalizerInProcess localizer(client, cloud);
  expect_flat_memory(flight, localizer, 200);
}

}  // namespace
}  // namespace fleetloc
