// What robots notice of others that search for their places: the answers' latency on one worker, in
// simulated time, with what each job takes in reality.
#include <algorithm>
#include <chrono>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "cloud/locate/pyramid_config.hpp"
#include "cloud/pool/localizer_pool.hpp"
#include "deploy/config/default_config.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/core/cpu_time.hpp"
#include "shared/core/percentile.hpp"
#include "shared/wire/session_codec.hpp"
#include "shared/wire/submap_codec.hpp"
#include "test/unit/localizer/simulated_session.hpp"

namespace fleetloc {
namespace {

constexpr Incarnation kIncarnation{3};
constexpr double kPeriod_s = 0.5;  // of each robot's keyframes
constexpr int kKeyframes = 100;
constexpr double kFull_s = 20.0;  // until then windows grow

/// Searches as soon as it has searched.
LocalizerPool::Config always_searching() {
  ConfigReader config = ConfigReader::from_string(default_config("everything"));
  config.overlay(
      ConfigReader::from_string("{localizer: {first_place: {next_way_cells: 0.01, "
                                "ambiguous_way_cells: 0.01, follow_way_cells: 0.01}}}"));
  return read_localizer_pool_config(config);
}

/// A keyframe, with the one before, which its edge refers to.
Submap submap_of(const SimulatedSession& robot, int keyframe) {
  Submap submap = robot.submap(keyframe);
  if (keyframe == 0) return submap;
  const Submap before = robot.submap(keyframe - 1);
  submap.keyframes.insert(submap.keyframes.begin(), before.keyframes.front());
  for (const auto& landmark : before.landmarks) {
    const bool is_new = std::ranges::none_of(
        submap.landmarks, [&landmark](const auto& other) { return other.id == landmark.id; });
    if (is_new) submap.landmarks.push_back(landmark);
  }
  std::ranges::sort(submap.landmarks, {}, &SubmapLandmark::id);
  return submap;
}

/// Robots that have a place, and robots that search.
struct Robots {
  int told = 0;
  int searching = 0;
  [[nodiscard]] int all() const { return told + searching; }
};

/// One worker, and robots that send keyframes in turn. The room is there twice: who is not told
/// where it is never knows in which one.
class Worker {
 public:
  /// @param others  that have their times, but do not send: so that runs can be compared
  Worker(const Robots& robots, int others)
      : robots_(robots.all()), times_(robots.all() + others), period_s_(kPeriod_s / times_) {
    for (int i = 0; i < robots_; ++i) {
      sources_.emplace_back(SimulatedSession::Config{.seed = static_cast<std::uint64_t>(i + 1),
                                                     .send_landmarks = true});
      RobotSession session = sources_.back().session();
      session.robot = name_of(i);
      session.localizer = "localizer";
      session.incarnation = kIncarnation;
      if (i >= robots.told) session.start.reset();
      pool_.receive({Topic::kSession, encode(session)}, at(0.0));
      if (i < robots.told) told_.push_back(session.robot);
    }
  }

  /// Works until `end_s`, and to the end of the job that is at hand then.
  void work_until(double end_s) {
    while (now_s_ < end_s) {
      auto job = pool_.take_job(at(now_s_));
      if (job) {
        now_s_ = work(*job, now_s_);
      } else {
        now_s_ = next_ < messages() ? std::min(end_s, arrival_s(next_)) : end_s;
      }
      for (; next_ < messages() && arrival_s(next_) <= now_s_; ++next_) send(next_);
    }
  }

  /// When the last keyframe arrives [s].
  [[nodiscard]] double end_s() const { return arrival_s(messages()); }

  /// [ms], from a keyframe's arrival to its answer, of robots that have a place.
  [[nodiscard]] const std::vector<double>& latencies_ms() const { return latencies_ms_; }

  [[nodiscard]] double busy_share() const { return busy_s_ / end_s(); }
  [[nodiscard]] double searching_share() const { return searching_s_ / end_s(); }

  /// Of jobs of robots that search.
  [[nodiscard]] const std::vector<double>& turns_ms() const { return turns_ms_; }

 private:
  static Timestamp at(double seconds) { return Timestamp{from_seconds(seconds)}; }
  static std::string name_of(int robot) { return "robot_" + std::to_string(robot); }
  [[nodiscard]] int messages() const { return kKeyframes * times_; }
  [[nodiscard]] double arrival_s(int message) const { return 1.0 + period_s_ * message; }

  void send(int message) {
    const int robot = message % times_;
    if (robot >= robots_) return;
    Submap submap = submap_of(sources_[static_cast<std::size_t>(robot)], message / times_);
    submap.robot = name_of(robot);
    submap.incarnation = kIncarnation;
    pool_.receive({Topic::kSubmap, encode(submap)}, at(arrival_s(message)));
  }

  double work(LocalizerPool::Job& job, double now_s) {
    const Duration before = thread_cpu_time();
    LocalizationResult answer = LocalizerPool::run(job);
    const double took_s = to_seconds(thread_cpu_time() - before);
    const double end_s = now_s + took_s;
    const bool has_place = std::ranges::find(told_, job.robot) != told_.end();
    if (has_place && now_s > kFull_s) {
      latencies_ms_.push_back(1e3 * (end_s - to_seconds(job.received.time_since_epoch())));
    }
    (has_place ? busy_s_ : searching_s_) += took_s;
    if (!has_place) turns_ms_.push_back(1e3 * took_s);
    pool_.finish(job, std::move(answer), 1e3 * took_s, at(end_s));
    return end_s;
  }

  int robots_;
  int times_;
  double period_s_;
  std::deque<SimulatedSession> sources_;
  std::vector<RobotId> told_;
  std::shared_ptr<const LaserMap> map_ = two_rooms({40.0, 0.0, 0.0});
  LocalizerPool pool_{
      "localizer", kIncarnation, map_, always_searching(), make_pyramid(*map_, kSmallPyramid)};
  std::vector<double> latencies_ms_;
  std::vector<double> turns_ms_;
  double now_s_ = 0.0;
  int next_ = 0;  ///< message
  double busy_s_ = 0.0;
  double searching_s_ = 0.0;
};

/// Of several runs.
struct Runs {
  std::vector<double> latencies_ms;
  std::vector<double> turns_ms;
  double busy_share = 0.0;
  double searching_share = 0.0;

  void add(const Worker& worker) {
    append(worker.latencies_ms(), latencies_ms);
    append(worker.turns_ms(), turns_ms);
    busy_share += worker.busy_share() / kRuns;
    searching_share += worker.searching_share() / kRuns;
  }

  static constexpr int kRuns = 3;

 private:
  static void append(const std::vector<double>& more, std::vector<double>& all) {
    all.insert(all.end(), more.begin(), more.end());
  }
};

/// Both take turns of a second, as the machine is not always as fast.
void work(Worker& one, Worker& other) {
  constexpr double kTurn_s = 1.0;
  for (double end_s = kTurn_s; end_s < one.end_s() + kTurn_s; end_s += kTurn_s) {
    one.work_until(end_s);
    other.work_until(end_s);
  }
}

/// Robots that have a place, alone and beside robots that search.
void answers(benchmark::State& state) {
  const Robots robots{.told = static_cast<int>(state.range(0)),
                      .searching = static_cast<int>(state.range(1))};
  for (auto _ : state) {
    Runs alone;
    Runs with;
    for (int run = 0; run < Runs::kRuns; ++run) {
      Worker without_search({.told = robots.told}, robots.searching);
      Worker with_search(robots, 0);
      work(without_search, with_search);
      alone.add(without_search);
      with.add(with_search);
    }
    const auto counter = [&state](const std::string& name, const auto& values, double share) {
      state.counters[name] = percentile(values, share).value_or(0.0);
    };
    counter("alone_p50_ms", alone.latencies_ms, 0.5);
    counter("alone_p99_ms", alone.latencies_ms, 0.99);
    counter("with_p50_ms", with.latencies_ms, 0.5);
    counter("with_p99_ms", with.latencies_ms, 0.99);
    counter("turn_p50_ms", with.turns_ms, 0.5);
    counter("turn_p99_ms", with.turns_ms, 0.99);
    state.counters["ratio_p99"] =
        state.counters["with_p99_ms"].value / state.counters["alone_p99_ms"].value;
    state.counters["load"] = with.busy_share;
    state.counters["searches"] = with.searching_share;
  }
}
BENCHMARK(answers)
    ->ArgNames({"robots", "searching"})
    ->Args({5, 1})
    ->Args({5, 3})
    ->Args({10, 1})
    ->Args({10, 3})
    ->Unit(benchmark::kSecond)
    ->Iterations(1);

}  // namespace
}  // namespace fleetloc
