#include "cloud/pool/early_samples.hpp"

#include <utility>

namespace fleetloc {
namespace {

constexpr std::size_t kMaxRobots = 256;
constexpr std::size_t kMaxSamples = 16;  // of a robot: what it sends at once, and some seconds
constexpr double kMaxAgeSeconds = 10.0;

}  // namespace

void EarlySamples::keep(const SubmapSample& sample, std::size_t bytes, Timestamp now) {
  if (!robots_.contains(sample.robot) && robots_.size() >= kMaxRobots) return;
  Kept& kept = robots_[sample.robot];
  const bool is_other =
      !kept.samples.empty() && (kept.samples.back().sample.session != sample.session);
  if (is_other) kept.samples.clear();
  kept.newest = now;
  if (kept.samples.size() < kMaxSamples) kept.samples.push_back({sample, bytes});
}

std::vector<EarlySamples::Sample> EarlySamples::take(const RobotId& robot, SessionNumber session) {
  auto found = robots_.extract(robot);
  if (!found) return {};
  auto samples = std::move(found.mapped().samples);
  std::erase_if(samples, [&](const Sample& one) { return one.sample.session != session; });
  return samples;
}

void EarlySamples::clean_up(Timestamp now) {
  std::erase_if(robots_, [&](const auto& item) {
    return to_seconds(now - item.second.newest) > kMaxAgeSeconds;
  });
}

}  // namespace fleetloc
