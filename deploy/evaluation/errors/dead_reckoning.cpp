#include "deploy/evaluation/errors/dead_reckoning.hpp"

#include <algorithm>
#include <optional>

namespace fleetloc {

Trajectory aligned_once(const Trajectory& odometry, const Trajectory& localization) {
  Trajectory reckoned;
  std::optional<Pose> T_map_odom;
  for (const StampedPose& localized : localization) {
    const auto found = std::ranges::lower_bound(odometry, localized.stamp, {}, &StampedPose::stamp);
    if (found == odometry.end() || found->stamp != localized.stamp) continue;
    const Pose& T_odom_body = found->T_ref_body;
    if (!T_map_odom) T_map_odom = localized.T_ref_body * inverse(T_odom_body);
    reckoned.push_back({localized.stamp, *T_map_odom * T_odom_body});
  }
  return reckoned;
}

}  // namespace fleetloc
