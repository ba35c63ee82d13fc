#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "deploy/replay/localizer_plan.hpp"
#include "deploy/replay/simulated_cloud.hpp"
#include "shared/link/memory_network.hpp"

namespace fleetloc {

/// The localizers of a replay, which start and end as a plan says.
class SimulatedLocalizers {
 public:
  struct Config {
    LocalizerPool::Config pool;
    MapRegions regions;
    Duration localization_time{};
    std::function<Duration()> cpu_clock;  ///< only for reports; may be null
  };

  SimulatedLocalizers(MemoryNetwork& network,
                      std::shared_ptr<const LaserMap> map,
                      std::shared_ptr<const MapPyramid> pyramid,
                      Config config,
                      LocalizerPlan plan);

  /// Everything that happens until `now`; the plan begins with the first call. To be called at
  /// small steps of time.
  void advance(Timestamp now);

  /// sessions.json of each, of its latest start: in `folder` of a localizer that is alone, else in
  /// a folder of its name.
  void write_reports(const std::filesystem::path& folder) const;

 private:
  struct Localizer {
    std::uint32_t starts = 0;
    std::unique_ptr<Channel> end;           // none: it does not run
    std::unique_ptr<SimulatedCloud> cloud;  // uses the end
    std::optional<Timestamp> draining_since;
    std::map<RobotId, SessionReport> reports;  // once it has ended
  };

  void apply(const LocalizerPlan::Event& event, Timestamp now);
  void start(const std::string& name, Localizer& localizer);
  static void end(Localizer& localizer);

  MemoryNetwork& network_;
  std::shared_ptr<const LaserMap> map_;
  std::shared_ptr<const MapPyramid> pyramid_;
  Config config_;
  LocalizerPlan plan_;
  std::size_t next_event_ = 0;
  std::optional<Timestamp> begin_;
  std::map<std::string, Localizer> localizers_;
};

}  // namespace fleetloc
