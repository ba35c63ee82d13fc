#include "shared/trajectory/trajectory.hpp"

#include <algorithm>
#include <iterator>

namespace fleetloc {

std::optional<Pose> interpolate(const Trajectory& trajectory, Timestamp stamp, Duration max_gap) {
  const auto after = std::ranges::lower_bound(trajectory, stamp, {}, &StampedPose::stamp);
  if (after == trajectory.end()) return std::nullopt;
  if (after->stamp == stamp) return after->T_ref_body;
  if (after == trajectory.begin()) return std::nullopt;
  const auto before = std::prev(after);
  const Duration gap = after->stamp - before->stamp;
  if (gap > max_gap) return std::nullopt;
  const double share = to_seconds(stamp - before->stamp) / to_seconds(gap);
  const Pose& from = before->T_ref_body;
  const Pose& to = after->T_ref_body;
  return Pose{.R = from.R.slerp(share, to.R), .p = from.p + share * (to.p - from.p)};
}

std::vector<PosePair> associate(const Trajectory& truth,
                                const Trajectory& estimate,
                                Duration max_gap) {
  std::vector<PosePair> pairs;
  for (const StampedPose& pose : estimate) {
    const auto T_truth_body = interpolate(truth, pose.stamp, max_gap);
    if (!T_truth_body) continue;
    pairs.push_back(
        {.stamp = pose.stamp, .T_truth_body = *T_truth_body, .T_estimate_body = pose.T_ref_body});
  }
  return pairs;
}

double coverage(std::span<const Timestamp> stamps, const Trajectory& estimate, Duration tolerance) {
  if (stamps.empty()) return 0.0;
  const auto covered = std::ranges::count_if(stamps, [&](Timestamp stamp) {
    const auto near =
        std::ranges::lower_bound(estimate, stamp - tolerance, {}, &StampedPose::stamp);
    return near != estimate.end() && near->stamp <= stamp + tolerance;
  });
  return static_cast<double>(covered) / static_cast<double>(stamps.size());
}

}  // namespace fleetloc
