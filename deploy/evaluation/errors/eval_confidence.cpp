#include "deploy/evaluation/errors/eval_confidence.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace fleetloc {
namespace {

constexpr double kWrongMetres = 0.5;
constexpr double kSigmas = 3.0;

// Position error in body axes over its covariance; the tangent is [rotation, translation].
double sigmas(const PosePair& pair, const Matrix6d& covariance) {
  const Eigen::Vector3d error_body =
      pair.T_estimate_body.R.conjugate() * (pair.T_truth_body.p - pair.T_estimate_body.p);
  const Eigen::Matrix3d P = covariance.bottomRightCorner<3, 3>();
  return std::sqrt(error_body.dot(P.ldlt().solve(error_body)));
}

}  // namespace

nlohmann::json confidence(const std::vector<PosePair>& map_poses,
                          const RunCovariances& covariances) {
  std::size_t localized = 0;
  std::size_t wrong = 0;
  double worst_m = 0.0;
  for (const PosePair& pair : map_poses) {
    const auto found =
        std::ranges::lower_bound(covariances.map, pair.stamp, {}, &StampedCovariance::stamp);
    if (found == covariances.map.end() || found->stamp != pair.stamp) continue;
    if (!std::ranges::binary_search(covariances.localized, pair.stamp)) continue;
    const double error_m = (pair.T_truth_body.p - pair.T_estimate_body.p).norm();
    ++localized;
    worst_m = std::max(worst_m, error_m);
    if (error_m > kWrongMetres && !(sigmas(pair, found->covariance) <= kSigmas)) ++wrong;
  }
  if (localized == 0) return nullptr;
  return {{"localized_frames", localized}, {"worst_m", worst_m}, {"confidently_wrong", wrong}};
}

}  // namespace fleetloc
