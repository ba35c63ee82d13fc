#pragma once

#include <memory>

#include "cloud/laser_map/build_map.hpp"
#include "cloud/pool/localizer_pool.hpp"
#include "test/hostile/fleet_samples.hpp"

namespace fleetloc {

/// The localizer cloud_1, whose map is four points: it finds nobody, and answers that.
class SmallPool {
 public:
  LocalizerPool& operator*() { return pool_; }
  LocalizerPool* operator->() { return &pool_; }

  /// Localizes whoever waits.
  void run_jobs(Timestamp now) {
    while (auto job = pool_.take_job(now)) {
      LocalizationResult answer = LocalizerPool::run(*job);
      pool_.finish(*job, std::move(answer), 1.0, now);
    }
  }

  /// What was refused of a robot, also while it is not served.
  std::uint64_t refused(const RobotId& robot, const std::string& reason) {
    const auto reports = pool_.reports();
    const auto report = reports.find(robot);
    if (report == reports.end()) {
      const auto all = pool_.unattributed().find(reason);
      return all == pool_.unattributed().end() ? 0 : all->second;
    }
    const auto count = report->second.refused.find(reason);
    return count == report->second.refused.end() ? 0 : count->second;
  }

 private:
  static ConfigReader config(const char* program) {
    return ConfigReader::from_string(default_config(program));
  }

  LocalizerPool pool_{
      "cloud_1",
      kIncarnation,
      std::make_shared<const LaserMap>(build_map({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}},
                                                 "map",
                                                 read_map_config(config("map").section("map")))),
      read_localizer_pool_config(config("cloud"))};
};

}  // namespace fleetloc
