#include "deploy/replay/simulated_localizers.hpp"

#include <utility>

#include "cloud/pool/sessions_report.hpp"

namespace fleetloc {
namespace {

constexpr Duration kGoodbye = std::chrono::milliseconds(300);  // as fleetloc-cloud

}  // namespace

SimulatedLocalizers::SimulatedLocalizers(MemoryNetwork& network,
                                         std::shared_ptr<const LaserMap> map,
                                         std::shared_ptr<const MapPyramid> pyramid,
                                         Config config,
                                         LocalizerPlan plan)
    : network_(network),
      map_(std::move(map)),
      pyramid_(std::move(pyramid)),
      config_(std::move(config)),
      plan_(std::move(plan)) {}

void SimulatedLocalizers::advance(Timestamp now) {
  if (!begin_) begin_ = now;
  while (next_event_ < plan_.events.size() &&
         to_seconds(now - *begin_) >= plan_.events[next_event_].at_s) {
    apply(plan_.events[next_event_++], now);
  }
  for (auto& [name, localizer] : localizers_) {
    if (!localizer.cloud) continue;
    localizer.cloud->advance(now);
    const bool has_said_it =
        localizer.draining_since && now - *localizer.draining_since >= kGoodbye;
    if (has_said_it && localizer.cloud->is_drained(now)) end(localizer);
  }
}

void SimulatedLocalizers::apply(const LocalizerPlan::Event& event, Timestamp now) {
  Localizer& localizer = localizers_[event.localizer];
  switch (event.kind) {
    case LocalizerPlan::Kind::kStart:
      end(localizer);
      start(event.localizer, localizer);
      break;
    case LocalizerPlan::Kind::kStop:
      if (!localizer.cloud || localizer.draining_since) return;
      localizer.cloud->drain(now);
      localizer.draining_since = now;
      break;
    case LocalizerPlan::Kind::kKill:
      end(localizer);
  }
}

void SimulatedLocalizers::start(const std::string& name, Localizer& localizer) {
  localizer.end = network_.join_cloud(name);
  localizer.cloud = std::make_unique<SimulatedCloud>(
      LocalizerPool(
          name, Incarnation{++localizer.starts}, map_, config_.pool, pyramid_, config_.regions),
      *localizer.end,
      config_.localization_time,
      config_.cpu_clock);
}

void SimulatedLocalizers::end(Localizer& localizer) {
  if (localizer.cloud) localizer.reports = localizer.cloud->pool().reports();
  localizer.cloud.reset();
  localizer.end.reset();
  localizer.draining_since.reset();
}

void SimulatedLocalizers::write_reports(const std::filesystem::path& folder) const {
  for (const auto& [name, localizer] : localizers_) {
    const std::filesystem::path own = localizers_.size() == 1 ? folder : folder / name;
    std::filesystem::create_directories(own);
    write_sessions(own / "sessions.json",
                   localizer.cloud ? localizer.cloud->pool().reports() : localizer.reports);
  }
}

}  // namespace fleetloc
