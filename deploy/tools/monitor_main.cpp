// fleetloc-monitor: shows robots and localizers while they run.
#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <iostream>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "cloud/laser_map/map_file.hpp"
#include "cloud/point_cloud/voxel_cloud.hpp"
#include "deploy/config/default_config.hpp"
#include "deploy/monitor/live_fleet.hpp"
#include "deploy/monitor/recorded_fleet.hpp"
#include "deploy/monitor/screen.hpp"
#include "shared/concurrency/termination.hpp"
#include "shared/config/program.hpp"
#include "shared/core/boot_time.hpp"
#include "shared/transport/monitoring/monitor_profiles.hpp"

namespace {

using namespace fleetloc;

struct Arguments {
  std::vector<std::string> runs;
  std::vector<std::string> truths;
  std::vector<std::string> localizers;
  bool once = false;
  std::uint32_t domain = 0;
  std::optional<std::filesystem::path> qos;
  std::string security;
  std::optional<int> http_port;
  std::string http_address = "127.0.0.1";
  std::string map;
};

/// What the page shows below the robots.
std::vector<Eigen::Vector3f> thinned_map(const std::string& file) {
  constexpr double kEdge_m = 0.2;
  constexpr std::size_t kMaxPoints = 60'000;
  if (file.empty()) return {};
  VoxelCloud thinned(kEdge_m, kMaxPoints);
  const LaserMap map = load_map(file);
  for (const MapPoint& point : map.points()) thinned.add(point.p_map.cast<double>());
  return thinned.points();
}

std::unique_ptr<WatchedFleet> watched(const Arguments& arguments) {
  if (!arguments.runs.empty()) {
    return std::make_unique<RecordedFleet>(arguments.runs, arguments.truths, arguments.localizers);
  }
  std::unique_ptr<FleetPage> page;
  if (arguments.http_port) {
    page = std::make_unique<FleetPage>(
        arguments.http_address, *arguments.http_port, thinned_map(arguments.map));
    std::cout << "http://" << arguments.http_address << ':' << page->port() << "/\n" << std::flush;
  }
  std::optional<FleetKeys> keys;
  if (!arguments.security.empty()) keys.emplace(arguments.security);
  load_monitor_profiles(arguments.qos, keys.has_value());
  return std::make_unique<LiveFleet>(arguments.domain, std::move(page), keys);
}

/// Waits, at most until `stop`.
void pause(std::chrono::milliseconds time, const std::stop_token& stop) {
  std::mutex mutex;
  std::condition_variable_any stopped;
  std::unique_lock lock(mutex);
  stopped.wait_for(lock, stop, time, [] { return false; });
}

int watch(WatchedFleet& fleet, const std::stop_token& stop) {
  constexpr std::chrono::milliseconds kLook(250);
  Screen screen;
  ArrivalTime next = boot_time();
  while (true) {
    const ArrivalTime now = boot_time();
    const FleetView view = fleet.update(now);
    const bool is_last = fleet.has_ended(view) || stop.stop_requested();
    if (is_last || now >= next) {
      screen.show(view);
      next = now + screen.interval();
    }
    if (is_last) return kSuccess;
    pause(kLook, stop);
  }
}

int show_once(WatchedFleet& fleet) {
  pause(fleet.settles_in(), {});
  std::cout << table(fleet.update(boot_time()));
  return kSuccess;
}

}  // namespace

int main(int argc, char** argv) {
  return fleetloc::guarded([&] {
    Program program("fleetloc-monitor",
                    "Shows how robots and localizers are doing: over DDS, as the localizers of a "
                    "domain tell it, until it is stopped; or, with --run, from the folders that "
                    "they write, until all runs have ended. On a terminal a table that is redrawn, "
                    "elsewhere a line every 10 s.",
                    default_config("everything"));
    Arguments arguments;
    CLI::App& app = program.options();
    app.add_option("--domain", arguments.domain, "DDS domain of the fleet, 0 to 100");
    app.add_option("--qos",
                   arguments.qos,
                   "QoS profiles; else qos_profiles/monitor.xml as it was when this was built");
    app.add_option("--security",
                   arguments.security,
                   "folder of its keys, made by deploy/security/fleet-keys.sh, where localizers "
                   "have some");
    auto* http = app.add_option("--http", arguments.http_port, "port of a page with map and robots")
                     ->check(CLI::Range(0, 65535));
    app.add_option("--http-address", arguments.http_address, "that it listens on")
        ->capture_default_str()
        ->needs(http);
    app.add_option("--map", arguments.map, "laser map that the page shows")->needs(http);
    auto* run = app.add_option("--run", arguments.runs, "run folders; they may appear later");
    run->excludes(http);
    app.add_option("--ground-truth",
                   arguments.truths,
                   "TUM file, or EuRoC's data.csv, one for all runs or one for each: shows errors")
        ->needs(run);
    app.add_option("--localizer", arguments.localizers, "folders of localizers")->needs(run);
    app.add_flag("--once", arguments.once, "show the table once, and end");
    return program.run(argc, argv, [&]() -> Program::Run {
      auto termination = std::make_shared<Termination>();  // before any thread
      auto fleet = std::make_shared<std::unique_ptr<WatchedFleet>>(watched(arguments));
      return [fleet, termination, once = arguments.once] {
        return once ? show_once(**fleet) : watch(**fleet, termination->token());
      };
    });
  });
}
