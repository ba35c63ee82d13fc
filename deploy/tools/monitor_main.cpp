// fleetloc-monitor: shows robots and localizers while they run.
#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <iostream>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include <unistd.h>

#include "cloud/laser_map/map_file.hpp"
#include "cloud/point_cloud/voxel_cloud.hpp"
#include "deploy/config/default_config.hpp"
#include "deploy/monitor/fleet_page.hpp"
#include "deploy/monitor/fleet_view.hpp"
#include "deploy/monitor/served_fleet.hpp"
#include "shared/concurrency/termination.hpp"
#include "shared/config/program.hpp"
#include "shared/core/boot_time.hpp"
#include "shared/trajectory/tum_file.hpp"
#include "shared/transport/monitoring/fleet_reader.hpp"
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
  std::optional<int> http_port;
  std::string http_address = "127.0.0.1";
  std::string map;
};

/// Run folders that are watched.
struct Recordings {
  std::vector<WatchedRun> runs;
  std::vector<WatchedLocalizer> localizers;
};

Recordings opened(const Arguments& arguments) {
  const std::size_t truths = arguments.truths.size();
  if (truths > 1 && truths != arguments.runs.size()) {
    throw std::invalid_argument("--ground-truth: " + std::to_string(truths) + " files for " +
                                std::to_string(arguments.runs.size()) +
                                " runs; give one for all of them, or one for each");
  }
  Recordings recordings;
  for (std::size_t i = 0; i < arguments.runs.size(); ++i) {
    Trajectory truth;
    if (truths > 0) truth = read_trajectory(arguments.truths[truths == 1 ? 0 : i]);
    recordings.runs.emplace_back(arguments.runs[i], std::move(truth));
  }
  for (const std::string& folder : arguments.localizers) {
    recordings.localizers.emplace_back(folder);
  }
  return recordings;
}

FleetView update(Recordings& recordings) {
  FleetView view;
  for (WatchedRun& run : recordings.runs) view.robots.push_back(run.update());
  for (WatchedLocalizer& one : recordings.localizers) view.localizers.push_back(one.update());
  return view;
}

/// On a terminal the table is drawn over the one before; elsewhere a line is added now and then.
class Screen {
 public:
  [[nodiscard]] std::chrono::milliseconds interval() const {
    return terminal_ ? std::chrono::milliseconds(500) : std::chrono::seconds(10);
  }

  void show(const FleetView& view) {
    if (!terminal_) {
      std::cout << line(view) << '\n' << std::flush;
      return;
    }
    if (lines_ > 0) std::cout << "\x1b[" << lines_ << "A\x1b[J";  // up, and clear from there on
    const std::string text = table(view);
    lines_ = std::ranges::count(text, '\n');
    std::cout << text << std::flush;
  }

 private:
  bool terminal_ = isatty(STDOUT_FILENO) == 1;
  std::ptrdiff_t lines_ = 0;
};

/// Waits, at most until `stop`.
class Pause {
 public:
  void wait(std::chrono::milliseconds time, const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    stopped_.wait_for(lock, stop, time, [] { return false; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable_any stopped_;
};

int watch(Recordings& recordings, const std::stop_token& stop) {
  constexpr std::chrono::milliseconds kLook(250);  // for the end of the runs
  using Clock = std::chrono::steady_clock;
  Screen screen;
  Pause pause;
  Clock::time_point next = Clock::now();
  while (true) {
    const FleetView view = update(recordings);
    const bool ended = std::ranges::all_of(view.robots, &RobotView::ended);
    const bool last = ended || stop.stop_requested();
    if (last || Clock::now() >= next) {
      screen.show(view);
      next = Clock::now() + screen.interval();
    }
    if (last) return kSuccess;
    pause.wait(kLook, stop);
  }
}

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

/// The fleet over DDS: on the terminal, and on a page.
class Live {
 public:
  explicit Live(const Arguments& arguments) : reader_(profiles_loaded(arguments)) {
    if (!arguments.http_port) return;
    page_.emplace(arguments.http_address, *arguments.http_port, thinned_map(arguments.map));
    std::cout << "http://" << arguments.http_address << ':' << page_->port() << "/\n" << std::flush;
  }

  int watch(const std::stop_token& stop) {
    constexpr std::chrono::milliseconds kInterval(250);
    Pause pause;
    Screen screen;
    ArrivalTime next = boot_time();
    while (!stop.stop_requested()) {
      const ArrivalTime now = boot_time();
      listen(now);
      if (page_) page_->show(json_of(fleet_));
      if (now >= next) {
        screen.show(view_of(fleet_));
        next = now + screen.interval();
      }
      pause.wait(kInterval, stop);
    }
    return kSuccess;
  }

  /// What is heard within two seconds.
  int once() {
    constexpr std::chrono::seconds kAll(2);
    Pause().wait(kAll, {});
    listen(boot_time());
    std::cout << table(view_of(fleet_));
    return kSuccess;
  }

 private:
  static std::uint32_t profiles_loaded(const Arguments& arguments) {
    load_monitor_profiles(arguments.qos);
    return arguments.domain;
  }

  void listen(ArrivalTime now) {
    for (const auto& news : reader_.take()) {
      std::visit([&](const auto& one) { fleet_.add(one, now); }, news);
    }
    fleet_.forget_silent(now);
  }

  FleetReader reader_;
  ServedFleet fleet_;
  std::optional<FleetPage> page_;
};

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
      if (arguments.runs.empty()) {
        auto live = std::make_shared<Live>(arguments);
        if (arguments.once) return [live] { return live->once(); };
        return [live, termination] { return live->watch(termination->token()); };
      }
      auto recordings = std::make_shared<Recordings>(opened(arguments));
      if (arguments.once) {
        return [recordings] {
          std::cout << table(update(*recordings));
          return static_cast<int>(kSuccess);
        };
      }
      return [recordings, termination] { return watch(*recordings, termination->token()); };
    });
  });
}
