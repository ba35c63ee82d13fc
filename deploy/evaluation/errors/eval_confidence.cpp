#include "deploy/evaluation/errors/eval_confidence.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "shared/geometry/angle.hpp"

namespace fleetloc {
namespace {

constexpr double kSigmas = 3.0;

/// Of one pose in the map.
struct PoseError {
  explicit PoseError(const PosePair& pair)
      : tangent(local_coordinates(pair.T_estimate_body, pair.T_truth_body)),
        metres((pair.T_truth_body.p - pair.T_estimate_body.p).norm()),
        degrees(kDegPerRad * tangent.head<3>().norm()) {}

  [[nodiscard]] bool is_wrong() const {
    return metres > kCoveredMetres || degrees > kCoveredDegrees;
  }
  [[nodiscard]] bool is_confidently_wrong(const Matrix6d& covariance) const {
    const auto exceeds = [](const Eigen::Vector3d& error, const Eigen::Matrix3d& P) {
      return !(std::sqrt(error.dot(P.ldlt().solve(error))) <= kSigmas);
    };
    return (metres > kCoveredMetres &&
            exceeds(tangent.tail<3>(), covariance.bottomRightCorner<3, 3>())) ||
           (degrees > kCoveredDegrees &&
            exceeds(tangent.head<3>(), covariance.topLeftCorner<3, 3>()));
  }

  Vector6d tangent;  ///< right perturbation of the estimate
  double metres;
  double degrees;
};

bool is_localized(const PosePair& pair, const RunCovariances& covariances) {
  return std::ranges::binary_search(covariances.localized, pair.stamp);
}

}  // namespace

nlohmann::json covered(const Trajectory& truth,
                       const std::vector<PosePair>& map_poses,
                       const RunCovariances& covariances,
                       Duration max_gap) {
  const auto with_truth = std::ranges::count_if(covariances.frames, [&](Timestamp stamp) {
    return interpolate(truth, stamp, max_gap).has_value();
  });
  if (with_truth == 0) return nullptr;
  const auto good = std::ranges::count_if(map_poses, [&](const PosePair& pair) {
    return is_localized(pair, covariances) && !PoseError(pair).is_wrong();
  });
  return static_cast<double>(good) / static_cast<double>(with_truth);
}

nlohmann::json confidence(const std::vector<PosePair>& map_poses,
                          const RunCovariances& covariances) {
  std::size_t localized = 0;
  std::size_t wrong = 0;
  std::size_t confidently_wrong = 0;
  double worst_m = 0.0;
  double worst_deg = 0.0;
  for (const PosePair& pair : map_poses) {
    const auto found =
        std::ranges::lower_bound(covariances.map, pair.stamp, {}, &StampedCovariance::stamp);
    if (found == covariances.map.end() || found->stamp != pair.stamp) continue;
    if (!is_localized(pair, covariances)) continue;
    const PoseError error(pair);
    ++localized;
    worst_m = std::max(worst_m, error.metres);
    worst_deg = std::max(worst_deg, error.degrees);
    if (error.is_wrong()) ++wrong;
    if (error.is_confidently_wrong(found->covariance)) ++confidently_wrong;
  }
  if (localized == 0) return nullptr;
  return {{"localized_frames", localized},
          {"worst_m", worst_m},
          {"worst_deg", worst_deg},
          {"wrong", wrong},
          {"confidently_wrong", confidently_wrong}};
}

}  // namespace fleetloc
