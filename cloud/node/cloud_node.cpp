#include "cloud/node/cloud_node.hpp"

#include <chrono>
#include <utility>

#include <spdlog/spdlog.h>

#include "cloud/laser_map/map_file.hpp"
#include "cloud/node/worker_pool.hpp"
#include "cloud/pool/sessions_report.hpp"
#include "shared/transport/dds_channel.hpp"

namespace fleetloc {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kPatience{5};  // between looks at the workers

// The localizer's own time: it only orders and measures, robots never see it.
Timestamp steady_now() {
  return Timestamp{std::chrono::steady_clock::now().time_since_epoch()};
}

// Later starts have higher numbers, whatever happened to the earlier ones.
Epoch epoch_of_this_start() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return Epoch{static_cast<std::uint32_t>(
      std::chrono::duration_cast<std::chrono::seconds>(now).count())};
}

/// Share of the workers' time in use, smoothed over a few seconds.
class Load {
 public:
  explicit Load(int workers) : workers_(workers), last_(steady_now()) {}
  void add(Duration busy) { busy_ += busy; }
  double update(Timestamp now) {
    const double elapsed = to_seconds(now - last_);
    if (elapsed < 1.0) return load_;
    load_ = 0.5 * load_ + 0.5 * to_seconds(busy_) / (elapsed * workers_);
    busy_ = {};
    last_ = now;
    return load_;
  }

 private:
  int workers_;
  Timestamp last_;
  Duration busy_{};
  double load_ = 0.0;
};

void serve(DdsChannel& channel, LocalizerPool& pool, int worker_count,
           const std::stop_token& stop) {
  WorkerPool workers(worker_count);
  Load load(worker_count);
  while (!stop.stop_requested()) {
    channel.wait_for_message(kPatience);
    for (const Message& message : channel.receive(steady_now())) {
      pool.receive(message, steady_now());
    }
    while (auto finished = workers.take()) {
      load.add(finished->cpu);
      pool.finish(finished->job, std::move(finished->answer), 1e3 * to_seconds(finished->cpu),
                  steady_now());
    }
    while (workers.has_room()) {
      auto job = pool.take_job();
      if (!job) break;
      workers.start(std::move(*job));
    }
    const Timestamp now = steady_now();
    for (auto& outgoing : pool.outgoing(now, load.update(now))) {
      channel.send(outgoing.partition, std::move(outgoing.message), now);
    }
  }
}

}  // namespace

void serve_map(const CloudNodeOptions& options, const LocalizerPool::Config& config,
               const std::stop_token& stop) {
  std::filesystem::create_directories(options.out);
  const auto map = std::make_shared<const LaserMap>(load_map(options.map));
  spdlog::info("{}: map {} with {} points", options.name, options.map.string(), map->size());
  DdsChannel channel({.domain = options.domain,
                      .qos_file = options.qos,
                      .role = DdsRole::kCloud,
                      .name = options.name,
                      .link = options.link});
  LocalizerPool pool(options.name, epoch_of_this_start(), map, config);
  spdlog::info("{}: serving on DDS domain {}", options.name, options.domain);
  serve(channel, pool, options.workers, stop);
  write_sessions(options.out / "sessions.json", pool.reports());
  spdlog::info("{}: stopped, {} robots served", options.name, pool.sessions());
}

}  // namespace fleetloc
