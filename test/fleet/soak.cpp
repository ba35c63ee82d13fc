// Hours of a fleet in containers: two localizers and four robots that drive through a made-up world
// in real time, with faults at random. What each process needs at the end is compared with what it
// needed a sixth of the time (five minutes at least) after the beginning, or after its last start.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <iterator>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>

#include "shared/config/program.hpp"
#include "test/fleet/driving_fleet.hpp"
#include "test/system/driven_world.hpp"
#include "test/system/run_watch.hpp"

namespace fleetloc {
namespace {

namespace fs = std::filesystem;
using std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr double kMaxGrowth = 0.1;  // of memory
constexpr double kSettling = 60.0;  // after the last fault, before the end [s]
constexpr double kWarmUp = 300.0;   // of a process [s]
constexpr std::array kBetweenFaults_s{20.0, 60.0};

/// What a process needs.
struct Needs {
  double memory_mb = 0.0;
  int threads = 0;
  int descriptors = 0;
};

/// Nothing if the process has ended meanwhile.
std::optional<Needs> needs_of(const std::string& pid) try {
  const fs::path folder = "/proc/" + pid;
  const std::string status = content_of(folder / "status");
  const auto number = [&status](const std::string& name) {
    return std::stod(status.substr(status.find(name) + name.size()));
  };
  const auto descriptors = std::distance(fs::directory_iterator(folder / "fd"), {});
  return Needs{.memory_mb = number("VmRSS:") / 1024.0,
               .threads = static_cast<int>(number("Threads:")),
               .descriptors = static_cast<int>(descriptors)};
} catch (const std::exception&) {
  return std::nullopt;
}

/// A process under watch. Threads come and go, to look up a name for example: what counts is the
/// most of them while it warmed up, and the fewest after the last fault.
struct Watched {
  double started_s = 0.0;
  Needs before;
  std::optional<Needs> now;
};

Needs fewest(const std::optional<Needs>& before, const Needs& now) {
  if (!before) return now;
  return {.memory_mb = now.memory_mb,
          .threads = std::min(before->threads, now.threads),
          .descriptors = std::min(before->descriptors, now.descriptors)};
}

Needs most(const Needs& before, const Needs& now) {
  return {.memory_mb = now.memory_mb,
          .threads = std::max(before.threads, now.threads),
          .descriptors = std::max(before.descriptors, now.descriptors)};
}

class Soak {
 public:
  Soak(double minutes, unsigned seed, const fs::path& out)
      : length_s_(60.0 * minutes),
        warm_up_s_(std::min(length_s_ / 3.0, std::max(length_s_ / 6.0, kWarmUp))),
        random_(seed),
        world_(DrivenWorld::kept(length_s_ + kStagger + 10.0)),
        robots_{{"robot_1", "east", world_.forward, 0.0},
                {"robot_2", "east", world_.reverse, 0.0},
                {"robot_3", "west", world_.forward, kStagger},
                {"robot_4", "west", world_.reverse, kStagger}},
        fleet_(out, world_.map, length_s_) {}

  /// Whether all went as it must.
  bool run() {
    fleet_.start_discovery();
    for (const std::string& name : localizers_) fleet_.start_localizer(name);
    for (const DrivingRobot& robot : robots_) fleet_.start_robot(robot, robot.id);
    for (const std::string& name : localizers_) watched_[name];
    for (const DrivingRobot& robot : robots_) watched_[robot.id];
    start_ = steady_clock::now();
    const double last_fault_s = length_s_ - kSettling;
    double next_s = drawn(kBetweenFaults_s[0], kBetweenFaults_s[1]);
    while (elapsed_s() < length_s_ - 5.0) {
      if (next_s < last_fault_s && elapsed_s() >= next_s) {
        fault();
        next_s = elapsed_s() + drawn(kBetweenFaults_s[0], kBetweenFaults_s[1]);
      }
      measure();
      std::this_thread::sleep_for(std::chrono::seconds(1));
    }
    return report();
  }

 private:
  static constexpr double kStagger = 20.0;  // [s]

  [[nodiscard]] double elapsed_s() const { return Seconds(steady_clock::now() - start_).count(); }
  double drawn(double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random_);
  }
  template <typename Range>
  const auto& one_of(const Range& range) {
    std::uniform_int_distribution<std::size_t> index(0, std::size(range) - 1);
    return range[index(random_)];
  }
  static void hold(double seconds) { std::this_thread::sleep_for(Seconds(seconds)); }

  // What needs memory afresh happens in the first half only, so that growth shows in the second.
  void fault() {
    const std::vector<std::function<std::string()>> gentle{[this] { return pause_localizer(); },
                                                           [this] { return interrupt_robot(); },
                                                           [this] { return restart_discovery(); }};
    const std::vector<std::function<std::string()>> all{
        gentle[0], gentle[1], gentle[2], [this] { return restart_localizers(); }};
    const double at_s = elapsed_s();
    const std::string what = one_of(at_s < length_s_ / 2.0 ? all : gentle)();
    std::printf("%7.1f s  %s\n", at_s, what.c_str());
    std::fflush(stdout);
    ++faults_;
  }

  std::string pause_localizer() {
    const std::string& name = one_of(localizers_);
    const double for_s = drawn(2.0, 15.0);
    fleet_.containers().pause(name);
    hold(for_s);
    fleet_.containers().unpause(name);
    return name + " paused for " + std::to_string(std::lround(for_s)) + " s";
  }

  std::string restart_localizers() {
    const std::vector<std::string> victims =
        drawn(0.0, 1.0) < 0.3 ? localizers_ : std::vector{one_of(localizers_)};
    for (const std::string& name : victims) fleet_.containers().kill(name);
    hold(drawn(1.0, 10.0));
    std::string what = "killed and restarted:";
    for (const std::string& name : victims) {
      fleet_.start_again(name);
      watched_[name] = {.started_s = elapsed_s(), .before = {}, .now = {}};
      what += " " + name;
    }
    return what;
  }

  std::string interrupt_robot() {
    const DrivingRobot& robot = one_of(robots_);
    const double for_s = drawn(2.0, 15.0);
    fleet_.containers().pull_out(robot.site, robot.id);
    hold(for_s);
    const int address = 100 + faults_ % 100;
    fleet_.containers().plug_in(robot.site, robot.id, address);
    return robot.id + " without a network for " + std::to_string(std::lround(for_s)) +
           " s, back with the address ." + std::to_string(address);
  }

  std::string restart_discovery() {
    fleet_.containers().kill("discovery");
    hold(drawn(1.0, 15.0));
    fleet_.containers().start_again("discovery");
    return "killed and restarted: discovery";
  }

  void measure() {
    for (auto& [name, watched] : watched_) {
      const std::string pid = fleet_.containers().inspect(name, "{{.State.Pid}}");
      if (pid == "0") continue;  // has ended; the report tells how
      const auto needs = needs_of(pid);
      if (!needs) continue;
      const Needs& now = *needs;
      if (elapsed_s() - watched.started_s < warm_up_s_) {
        watched.before = most(watched.before, now);
      } else if (elapsed_s() > length_s_ - kSettling) {
        watched.now = fewest(watched.now, now);
      }
    }
  }

  bool report() {
    bool good = true;
    std::printf("%d faults\n%-12s %18s %10s %13s\n",
                faults_,
                "process",
                "memory MB",
                "threads",
                "descriptors");
    for (const auto& [name, watched] : watched_) {
      if (!watched.now) {
        std::printf("%-12s ran for too short\n", name.c_str());
        good = false;
        continue;
      }
      const Needs& before = watched.before;
      const Needs& now = *watched.now;
      const bool has_grown = now.memory_mb > (1.0 + kMaxGrowth) * before.memory_mb ||
                             now.threads > before.threads || now.descriptors > before.descriptors;
      good = good && !has_grown;
      std::printf("%-12s %7.1f -> %7.1f %4d -> %3d %5d -> %4d%s\n",
                  name.c_str(),
                  before.memory_mb,
                  now.memory_mb,
                  before.threads,
                  now.threads,
                  before.descriptors,
                  now.descriptors,
                  has_grown ? "  GROWN" : "");
    }
    for (const DrivingRobot& robot : robots_) good = report_run(robot) && good;
    for (const std::string& name : localizers_) {
      const int exit_code = fleet_.containers().stop(name);
      const std::string damage = damage_of(fleet_.folder_of(name));
      if (exit_code != 0) std::printf("%s: exit code %d\n", name.c_str(), exit_code);
      std::printf("%s", damage.c_str());
      good = good && exit_code == 0 && damage.empty();
    }
    return good;
  }

  bool report_run(const DrivingRobot& robot) {
    const auto run = fleet_.folder_of(robot.id);
    const int exit_code = fleet_.containers().wait(robot.id);
    const std::string damage = damage_of(run);
    const auto errors = run_errors(run, robot.flight);
    const auto& confidence = errors.at("confidence");
    const std::string state = frames_of(run).back().state;
    std::printf(
        "%s: exit code %d, %s at the end, ATE median %.3f m, covered %.3f, worst %.3f m "
        "while localized, %d frames confidently wrong\n%s",
        robot.id.c_str(),
        exit_code,
        state.c_str(),
        errors.at("ate").at("median").get<double>(),
        errors.at("covered").get<double>(),
        confidence.at("worst_m").get<double>(),
        confidence.at("confidently_wrong").get<int>(),
        damage.c_str());
    return exit_code == 0 && damage.empty() && state == "localized" &&
           confidence.at("confidently_wrong") == 0;
  }

  double length_s_;
  double warm_up_s_;
  std::mt19937 random_;
  DrivenWorld world_;
  std::vector<DrivingRobot> robots_;
  std::vector<std::string> localizers_{"localizer_1", "localizer_2"};
  DrivingFleet fleet_;
  std::map<std::string, Watched> watched_;
  steady_clock::time_point start_;
  int faults_ = 0;
};

}  // namespace
}  // namespace fleetloc

int main(int argc, char** argv) {
  using namespace fleetloc;
  return guarded([&] {
    CLI::App app("Runs a fleet in containers for long, with faults at random; see soak.sh.");
    double minutes = 60.0;
    unsigned seed = 1;
    std::string out;
    app.add_option("--minutes", minutes, "length of each robot's drive")
        ->check(CLI::Range(3, 600))
        ->capture_default_str();
    app.add_option("--seed", seed, "of the faults")->capture_default_str();
    app.add_option("--out", out, "run folders; default: a folder that is removed afterwards");
    CLI11_PARSE(app, argc, argv);
    if (const auto reason = DockerFleet::why_impossible()) throw std::runtime_error(*reason);
    const ScratchFolder scratch;
    const auto folder = out.empty() ? scratch / "runs" : fs::absolute(out);
    fs::create_directories(folder);
    const bool good = Soak(minutes, seed, folder).run();
    std::cout << (good ? "all well\n" : "FAILED\n");
    return static_cast<int>(good ? kSuccess : kFailedAtRunTime);
  });
}
