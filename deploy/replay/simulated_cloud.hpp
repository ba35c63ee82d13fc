#pragma once

#include <functional>
#include <optional>

#include "cloud/pool/localizer_pool.hpp"
#include "cloud/pool/worker_load.hpp"
#include "shared/link/channel.hpp"

namespace fleetloc {

/// A localizer in simulated time, with one worker: each localization takes a fixed time,
/// independent of this machine.
class SimulatedCloud {
 public:
  /// @param cpu_clock  only for reports; may be null
  SimulatedCloud(LocalizerPool pool,
                 Channel& channel,
                 Duration localization_time,
                 std::function<Duration()> cpu_clock);

  /// Everything that happens until `now`. To be called at small steps of time.
  void advance(Timestamp now);

  /// It is told to stop: goes on until is_drained().
  void drain(Timestamp now) { pool_.drain(now); }
  [[nodiscard]] bool is_drained(Timestamp now) const { return pool_.to_leave(now).empty(); }

  [[nodiscard]] const LocalizerPool& pool() const { return pool_; }

 private:
  struct Running {
    LocalizerPool::Job job;
    LocalizationResult answer;
    double optimize_ms = 0.0;
    Timestamp ready;
  };
  void start_next(Timestamp now);

  LocalizerPool pool_;
  Channel& channel_;
  Duration localization_time_;
  std::function<Duration()> cpu_clock_;
  std::optional<Running> running_;
  std::optional<WorkerLoad> load_;
};

}  // namespace fleetloc
