#include "deploy/replay/simulated_cloud.hpp"

#include <utility>

namespace fleetloc {
namespace {

constexpr int kSearchTurns = 10;  // of a search, in the time of a localization

}  // namespace

SimulatedCloud::SimulatedCloud(LocalizerPool pool,
                               Channel& channel,
                               Duration localization_time,
                               std::function<Duration()> cpu_clock)
    : pool_(std::move(pool)),
      channel_(channel),
      localization_time_(localization_time),
      cpu_clock_(std::move(cpu_clock)) {}

void SimulatedCloud::advance(Timestamp now) {
  for (const Message& message : channel_.receive(now)) pool_.receive(message, now);
  for (const RobotId& robot : pool_.take_expected()) channel_.prepare(robot);
  if (!load_) load_.emplace(1, now);
  if (running_ && running_->ready <= now) {
    if (!running_->job.submaps.empty()) load_->add(localization_time_);
    pool_.finish(running_->job, std::move(running_->answer), running_->optimize_ms, now);
    running_.reset();
  }
  if (!running_) start_next(now);
  for (auto& outgoing : pool_.outgoing(now, load_->measure(now))) {
    channel_.send(outgoing.partition, std::move(outgoing.message), now);
  }
}

void SimulatedCloud::start_next(Timestamp now) {
  auto job = pool_.take_job(now);
  if (!job) return;
  const Duration begin = cpu_clock_ ? cpu_clock_() : Duration{};
  LocalizationResult answer = LocalizerPool::run(*job);
  const Duration cpu = cpu_clock_ ? cpu_clock_() - begin : Duration{};
  const bool is_search = job->submaps.empty() && answer.status != LocalizationStatus::kLocalized;
  const Duration takes = is_search ? localization_time_ / kSearchTurns : localization_time_;
  running_ = {std::move(*job), std::move(answer), 1e3 * to_seconds(cpu), now + takes};
}

}  // namespace fleetloc
