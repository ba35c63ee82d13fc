// fleetloc-monitor: shows robots and localizers while they run.
#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <iostream>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <vector>

#include <unistd.h>

#include "deploy/config/default_config.hpp"
#include "deploy/monitor/fleet_view.hpp"
#include "shared/concurrency/termination.hpp"
#include "shared/config/program.hpp"
#include "shared/trajectory/tum_file.hpp"

namespace {

using namespace fleetloc;

struct Arguments {
  std::vector<std::string> runs;
  std::vector<std::string> truths;
  std::vector<std::string> localizers;
  bool once = false;
};

/// What is watched.
struct Fleet {
  std::vector<WatchedRun> runs;
  std::vector<WatchedLocalizer> localizers;
};

Fleet opened(const Arguments& arguments) {
  const std::size_t truths = arguments.truths.size();
  if (truths > 1 && truths != arguments.runs.size()) {
    throw std::invalid_argument("--ground-truth: " + std::to_string(truths) + " files for " +
                                std::to_string(arguments.runs.size()) +
                                " runs; give one for all of them, or one for each");
  }
  Fleet fleet;
  for (std::size_t i = 0; i < arguments.runs.size(); ++i) {
    Trajectory truth;
    if (truths > 0) truth = read_trajectory(arguments.truths[truths == 1 ? 0 : i]);
    fleet.runs.emplace_back(arguments.runs[i], std::move(truth));
  }
  for (const std::string& folder : arguments.localizers) fleet.localizers.emplace_back(folder);
  return fleet;
}

FleetView update(Fleet& fleet) {
  FleetView view;
  for (WatchedRun& run : fleet.runs) view.robots.push_back(run.update());
  for (WatchedLocalizer& one : fleet.localizers) view.localizers.push_back(one.update());
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

int watch(Fleet& fleet, const std::stop_token& stop) {
  constexpr std::chrono::milliseconds kLook(250);  // for the end of the runs
  using Clock = std::chrono::steady_clock;
  Screen screen;
  std::mutex mutex;
  std::condition_variable_any stopped;
  Clock::time_point next = Clock::now();
  while (true) {
    const FleetView view = update(fleet);
    const bool ended = std::ranges::all_of(view.robots, &RobotView::ended);
    const bool last = ended || stop.stop_requested();
    if (last || Clock::now() >= next) {
      screen.show(view);
      next = Clock::now() + screen.interval();
    }
    if (last) return kSuccess;
    std::unique_lock lock(mutex);
    stopped.wait_for(lock, stop, kLook, [] { return false; });
  }
}

}  // namespace

int main(int argc, char** argv) {
  return fleetloc::guarded([&] {
    Program program("fleetloc-monitor",
                    "Shows how robots and localizers are doing, from the folders that they write, "
                    "until all runs have ended: on a terminal a table that is redrawn, elsewhere a "
                    "line every 10 s.",
                    default_config("everything"));
    Arguments arguments;
    CLI::App& app = program.options();
    app.add_option("--run", arguments.runs, "run folders; they may appear later")->required();
    app.add_option("--ground-truth",
                   arguments.truths,
                   "TUM file, or EuRoC's data.csv, one for all runs or one for each: shows errors");
    app.add_option("--localizer", arguments.localizers, "folders of localizers");
    app.add_flag("--once", arguments.once, "show the table once, and end");
    return program.run(argc, argv, [&]() -> Program::Run {
      auto termination = std::make_shared<Termination>();  // before any thread
      auto fleet = std::make_shared<Fleet>(opened(arguments));
      if (arguments.once) {
        return [fleet] {
          std::cout << table(update(*fleet));
          return static_cast<int>(kSuccess);
        };
      }
      return [fleet, termination] { return watch(*fleet, termination->token()); };
    });
  });
}
