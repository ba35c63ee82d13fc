#include "cloud/node/cloud_node.hpp"

#include <chrono>
#include <stdexcept>
#include <utility>

#include <spdlog/spdlog.h>

#include "cloud/laser_map/map_file.hpp"
#include "cloud/pool/sessions_report.hpp"

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
  return Epoch{
      static_cast<std::uint32_t>(std::chrono::duration_cast<std::chrono::seconds>(now).count())};
}

DdsChannel::Config channel_config(const CloudNodeOptions& options) {
  load_qos_profiles(options.qos);
  return {.domain = options.domain,
          .participant_profile = "cloud",
          .role = ChannelRole::kCloud,
          .name = options.name,
          .link = options.link};
}

/// Share of the workers' time in use, smoothed over a few seconds.
class Load {
 public:
  explicit Load(int workers) : workers_(workers), last_(steady_now()) {}

  /// @param busy  since the last measurement; set to zero when it has been taken over
  double measure(Duration& busy, Timestamp now) {
    const double elapsed_s = to_seconds(now - last_);
    if (elapsed_s < 1.0) return load_;
    load_ = 0.5 * load_ + 0.5 * to_seconds(busy) / (elapsed_s * workers_);
    busy = {};
    last_ = now;
    return load_;
  }

 private:
  int workers_;
  Timestamp last_;
  double load_ = 0.0;
};

std::filesystem::path created(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw std::runtime_error(folder.string() + ": " + error.message());
  return folder;
}

}  // namespace

CloudNode::CloudNode(const CloudNodeOptions& options, const LocalizerPool::Config& config)
    : options_(options),
      map_(std::make_shared<const LaserMap>(load_map(options.map))),
      channel_(channel_config(options)),
      pool_(options.name, epoch_of_this_start(), map_, config) {
  options_.out = created(options.out);
}

void CloudNode::run(const std::stop_token& stop) {
  spdlog::info("{}: serving {} with {} points on DDS domain {}",
               options_.name,
               options_.map.string(),
               map_->size(),
               options_.domain);
  {
    WorkerPool workers(options_.workers);
    Load load(options_.workers);
    while (!stop.stop_requested()) {
      channel_.wait_for_message(kPatience);
      for (const Message& message : channel_.receive({})) pool_.receive(message, steady_now());
      finish_jobs(workers);
      start_jobs(workers);
      const Timestamp now = steady_now();
      for (auto& outgoing : pool_.outgoing(now, load.measure(busy_, now))) {
        channel_.send(outgoing.partition, std::move(outgoing.message), now);
      }
    }
    workers.finish();
    finish_jobs(workers);
  }
  for (const auto& [reason, count] : pool_.unattributed()) {
    spdlog::warn("{}: {} messages of no session: {}", options_.name, count, reason);
  }
  write_sessions(options_.out / "sessions.json", pool_.reports());
  spdlog::info("{}: stopped, {} robots served", options_.name, pool_.sessions());
}

void CloudNode::finish_jobs(WorkerPool& workers) {
  while (auto finished = workers.take()) {
    busy_ += finished->cpu;
    pool_.finish(
        finished->job, std::move(finished->answer), 1e3 * to_seconds(finished->cpu), steady_now());
  }
}

void CloudNode::start_jobs(WorkerPool& workers) {
  while (workers.has_room()) {
    auto job = pool_.take_job();
    if (!job) return;
    workers.start(std::move(*job));
  }
}

}  // namespace fleetloc
