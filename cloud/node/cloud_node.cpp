#include "cloud/node/cloud_node.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>

#include <spdlog/spdlog.h>

#include "cloud/laser_map/map_file.hpp"
#include "cloud/laser_map/map_regions.hpp"
#include "cloud/locate/pyramid_config.hpp"
#include "cloud/locate/pyramid_file.hpp"
#include "cloud/pool/sessions_report.hpp"
#include "shared/core/boot_time.hpp"
#include "shared/transport/monitoring/monitor_profiles.hpp"

namespace fleetloc {
namespace {

using std::chrono::milliseconds;

constexpr const char* kSessions = "sessions.json";

constexpr milliseconds kPatience{5};   // between looks at what is to be repeated or told
constexpr milliseconds kGoodbye{300};  // for the status that says it to be on its way

// The localizer's own clock: for order and durations, never sent to robots.
Timestamp steady_now() {
  return Timestamp{std::chrono::steady_clock::now().time_since_epoch()};
}

// Later starts have higher numbers, whatever happened to the earlier ones: tenths of a second since
// 2025, up to 2038.
Incarnation incarnation_of_this_start() {
  constexpr std::chrono::sys_days kBegin = std::chrono::year(2025) / 1 / 1;
  using Tenths = std::chrono::duration<std::int64_t, std::deci>;
  const auto since = std::chrono::system_clock::now() - kBegin;
  return Incarnation{static_cast<std::uint32_t>(std::chrono::duration_cast<Tenths>(since).count())};
}

DdsChannel::Config channel_config(const CloudNodeOptions& options) {
  load_qos_profiles(options.qos);
  return {.domain = options.domain,
          .participant_profile = "cloud",
          .role = ChannelRole::kCloud,
          .name = options.name,
          .link = options.link,
          .keys = options.keys};
}

std::uint32_t domain_with_profiles(const CloudNodeOptions& options) {
  load_monitor_profiles(options.monitor_qos, options.keys.has_value());
  return options.domain;
}

std::shared_ptr<const MapPyramid> pyramid_of(const LaserMap& map,
                                             const CloudNodeOptions& options,
                                             const PyramidConfig& config) {
  PreparedPyramid prepared = prepare_pyramid(map, options.map, config);
  if (!prepared.why_made.empty()) {
    spdlog::info(
        "{}: {} {}, so that it was made at this start: 'fleetloc-map pyramid {}' stores it",
        options.name,
        pyramid_file(options.map).string(),
        prepared.why_made,
        options.map.string());
  }
  return prepared.pyramid;
}

}  // namespace

CloudNode::CloudNode(const CloudNodeOptions& options,
                     const CloudNodeConfig& config,
                     ReloadRequest& reload)
    : options_(options),
      reload_(reload),
      out_(options.out.empty() ? nullptr : std::make_unique<const OutputFolder>(options.out)),
      map_(std::make_shared<const LaserMap>(load_map(options.map))),
      channel_(channel_config(options)),
      pool_(options.name,
            incarnation_of_this_start(),
            map_,
            config.pool,
            pyramid_of(*map_, options, config.pool.pyramid),
            load_map_regions(options.map)),
      fleet_(domain_with_profiles(options), options.keys) {
  if (!options.out.empty()) {
    std::filesystem::remove(options.out / kSessions);  // of the start before
    log_.emplace(options.out / "status.csv", steady_now());
  }
  if (options.publish_map_voxel_m) {
    map_publisher_.emplace(*map_, *options.publish_map_voxel_m, config.map_publisher);
    spdlog::info("{}: {} points of the map on {}, DDS domain {}",
                 options.name,
                 map_publisher_->points(),
                 config.map_publisher.topic,
                 config.map_publisher.domain);
  }
}

void CloudNode::run(const std::stop_token& stop, const std::stop_token& urgent) {
  spdlog::info("{}: serving {} with {} points on DDS domain {}, {} workers",
               options_.name,
               options_.map.string(),
               map_->size(),
               options_.domain,
               options_.workers);
  const std::stop_callback stopping(stop, [this] { service_.stopping(); });
  service_.ready();
  {
    WorkerPool workers(options_.workers, [this] { channel_.wake(); });
    WorkerLoad load(options_.workers, steady_now());
    while (!is_over(stop, urgent)) serve(workers, load);
    workers.finish();
    finish_jobs(workers, load);
  }
  for (const auto& [reason, count] : pool_.unattributed()) {
    spdlog::warn("{}: {} messages of robots that are not served: {}", options_.name, count, reason);
  }
  if (!options_.out.empty()) write_sessions(options_.out / kSessions, pool_.reports());
  spdlog::info("{}: stopped, {} robots served", options_.name, pool_.reports().size());
}

// After the first signal the robots are given time to go elsewhere. One that has ended, or whose
// network is gone, is not waited for.
bool CloudNode::is_over(const std::stop_token& stop, const std::stop_token& urgent) {
  if (!stop.stop_requested()) return false;
  if (urgent.stop_requested()) return true;
  const Timestamp now = steady_now();
  if (!draining_since_) {
    draining_since_ = now;
    pool_.drain(now);
    spdlog::info("{}: draining, {} robots have to leave", options_.name, pool_.sessions());
  }
  if (now - *draining_since_ < kGoodbye) return false;
  return std::ranges::none_of(pool_.to_leave(now), [this](const RobotId& robot) {
    return channel_.matched_readers(Topic::kLocalization, robot) > 0;
  });
}

void CloudNode::serve(WorkerPool& workers, WorkerLoad& load) {
  channel_.wait_for_message(kPatience);
  for (const Message& message : channel_.receive({})) pool_.receive(message, steady_now());
  for (const RobotId& robot : pool_.take_expected()) channel_.prepare(robot);
  finish_jobs(workers, load);
  start_jobs(workers);
  const Timestamp now = steady_now();
  const double share = load.measure(now);
  for (auto& outgoing : pool_.outgoing(now, share)) {
    channel_.send(outgoing.partition, std::move(outgoing.message), now);
  }
  report(share, now);
}

void CloudNode::report(double load, Timestamp now) {
  const ArrivalTime uptime = boot_time();
  service_.alive(uptime);
  service_.status(std::to_string(pool_.sessions()) + " robots", uptime);
  log_status(load, now);
  tell_watchers(now);
  for (const std::string& event : channel_.take_events()) {
    spdlog::info("{}: {}", options_.name, event);
  }
  for (const std::string& event : pool_.take_events()) {
    spdlog::info("{}: {}", options_.name, event);
  }
}

// A full disk ends the log, not the localizer.
void CloudNode::log_status(double load, Timestamp now) {
  const bool is_anew = reload_.take();
  if (is_anew) {
    spdlog::info("{}: SIGHUP: {}", options_.name, log_ ? "status.csv anew" : "nothing to reload");
  }
  if (!log_) return;
  try {
    if (is_anew) log_->begin_anew();
    log_->add(pool_, load, now);
  } catch (const std::runtime_error& error) {
    spdlog::error("{}: status.csv ends here: {}", options_.name, error.what());
    log_.reset();
  }
}

void CloudNode::tell_watchers(Timestamp now) {
  constexpr milliseconds kInterval{500};
  if (told_ && now - *told_ < kInterval) return;
  told_ = now;
  if (fleet_.is_watched()) fleet_.write(pool_.status(), pool_.served(now));
}

void CloudNode::finish_jobs(WorkerPool& workers, WorkerLoad& load) {
  while (auto finished = workers.take()) {
    // A search waits for everybody else, so that it keeps no robot out.
    if (!finished->job.submaps.empty()) load.add(finished->busy);
    pool_.finish(
        finished->job, std::move(finished->answer), 1e3 * to_seconds(finished->cpu), steady_now());
  }
}

void CloudNode::start_jobs(WorkerPool& workers) {
  while (workers.has_free_worker()) {
    auto job = pool_.take_job(steady_now());
    if (!job) return;
    workers.start(std::move(*job));
  }
}

}  // namespace fleetloc
