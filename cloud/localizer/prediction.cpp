#include "cloud/localizer/prediction.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include "shared/core/percentile.hpp"
#include "shared/geometry/covariance.hpp"

namespace fleetloc {

double landmark_sigma(const LandmarkPositions& positions, const PoseWithCovariance& estimate) {
  std::vector<double> distances;
  distances.reserve(positions.size());
  for (const auto& [id, p_map] : positions) {
    distances.push_back((p_map - estimate.T_map_body.p).norm());
  }
  const double turned = percentile(std::move(distances), 0.5).value_or(0.0) *
                        max_sigma(estimate.covariance.topLeftCorner<3, 3>());
  const double shifted = max_sigma(estimate.covariance.bottomRightCorner<3, 3>());
  return std::hypot(turned, shifted);
}

}  // namespace fleetloc
