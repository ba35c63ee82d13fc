#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "shared/geometry/pose.hpp"

namespace fleetloc {

struct IcpConfig {
  double max_distance_m = 0.0;  ///< between a point and its nearest one in the target
  int iterations = 0;           ///< at most
  double settled_m = 0.0;       ///< converged: the last step was no larger
};

/// Result of one alignment.
struct IcpResult {
  Pose T_target_source;
  bool converged = false;
  double matched_share = 0.0;  ///< of the source's points, by IcpConfig::max_distance_m, at the end
  double rms_m = 0.0;          ///< of their distances
};

/// Iterative closest point, point to point (Besl and McKay: A method for registration of 3-D
/// shapes, 1992), as PCL has it: a baseline to compare with. The target's k-d tree is built once.
class IcpTarget {
 public:
  /// @param points  of the target [m]; not empty
  explicit IcpTarget(const std::vector<Eigen::Vector3f>& points);
  IcpTarget(IcpTarget&& other) noexcept;
  IcpTarget& operator=(IcpTarget&& other) noexcept;
  IcpTarget(const IcpTarget&) = delete;
  IcpTarget& operator=(const IcpTarget&) = delete;
  ~IcpTarget();

  /// Moves `source` onto the target, beginning at `start`. Less than three points near the target
  /// do not converge.
  [[nodiscard]] IcpResult align(const std::vector<Eigen::Vector3d>& source,
                                const Pose& start,
                                const IcpConfig& config) const;

 private:
  struct Cloud;
  std::unique_ptr<const Cloud> cloud_;
};

}  // namespace fleetloc
