#include "cloud/localizer/map_fit.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include "shared/core/percentile.hpp"

namespace fleetloc {

void MapFit::add(const WindowProblem::Solved& solved) {
  is_solved = solved.is_usable;
  ++rounds;
  iterations += solved.iterations;
  cost = solved.cost;
}

double median_residual(const std::vector<MapMatch>& matches,
                       const LandmarkPositions& positions,
                       const AssociationConfig& config) {
  std::vector<double> residuals;
  residuals.reserve(matches.size());
  for (const MapMatch& match : matches) {
    const double error = residual(match, positions.at(match.landmark.id));
    // A distance in space is sqrt(3) times the error along one axis.
    residuals.push_back(match.is_planar ? std::abs(error) / config.plane_sigma_m
                                        : error / (std::sqrt(3.0) * config.point_sigma_m));
  }
  return percentile(std::move(residuals), 0.5).value_or(0.0);
}

}  // namespace fleetloc
