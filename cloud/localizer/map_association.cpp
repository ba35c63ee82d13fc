#include "cloud/localizer/map_association.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include <Eigen/Cholesky>

#include "shared/geometry/covariance.hpp"

namespace fleetloc {
namespace {

constexpr double kShareOfGate = 0.25;  // sigma of a match while the gate is wide

using Cell = std::array<long, 3>;

Cell cell_of(const Eigen::Vector3d& p_map, double edge_m) {
  const auto index = [edge_m](double x) { return std::lround(std::floor(x / edge_m)); };
  return {index(p_map.x()), index(p_map.y()), index(p_map.z())};
}

// Whether the landmark may lie on the surface around the map point: the distance against the gate,
// the landmark's uncertainty, and, along a plane, the spacing of the map's points.
bool is_within_gate(const MapMatch& match, double gate_m, double spacing_m, double sigmas) {
  const double sigma = gate_m / sigmas;
  Eigen::Matrix3d spread = match.landmark.covariance + sigma * sigma * Eigen::Matrix3d::Identity();
  if (match.is_planar) {
    spread += spacing_m * spacing_m *
              (Eigen::Matrix3d::Identity() - match.normal * match.normal.transpose());
  }
  const Eigen::Vector3d d = match.landmark.p_map - match.q_map;
  return d.dot(spread.ldlt().solve(d)) <= sigmas * sigmas;
}

// Beyond the gate, and behind the surface as seen from the camera. New objects may stand in front
// of the mapped surfaces, but landmarks behind them cannot be observed.
bool is_occluded(const MapMatch& nearest, double gate_m) {
  if (!nearest.is_planar) return false;
  const double viewer = nearest.normal.dot(nearest.landmark.viewpoint_map - nearest.q_map);
  const double landmark = nearest.normal.dot(nearest.landmark.p_map - nearest.q_map);
  return viewer * landmark < 0.0 && std::abs(landmark) > gate_m;
}

// Ground constrains height only: snow, leaves and grass raise all of it alike, and on a slope such
// an error of height would become a horizontal one.
void make_level(MapMatch& match) {
  match.is_level = true;
  const Eigen::Vector3d& p_map = match.landmark.p_map;
  const double height = match.normal.dot(p_map - match.q_map) / match.normal.z();
  match.q_map = p_map - height * Eigen::Vector3d::UnitZ();
  match.normal = Eigen::Vector3d::UnitZ();
}

MapMatch make_match(const WindowLandmark& landmark,
                    std::size_t index,
                    const MapPoint& point,
                    double gate_m,
                    const AssociationConfig& config) {
  MapMatch match;
  match.landmark = landmark;
  match.map_point = index;
  match.q_map = point.p_map.cast<double>();
  match.normal = point.normal.cast<double>();
  match.is_planar = point.planarity >= config.min_planarity && match.normal.squaredNorm() > 0.5;
  if (match.is_planar && std::abs(match.normal.z()) >= config.level_from) make_level(match);
  match.sigma_m = match.is_planar ? config.plane_sigma_m : config.point_sigma_m;
  match.widening = std::max(1.0, kShareOfGate * gate_m / match.sigma_m);
  return match;
}

// Neighbouring landmarks share the errors of the map, so a cell counts no more than
// `matches_per_cell` independent matches.
void cap_information(std::vector<MapMatch>& matches, const AssociationConfig& config) {
  std::map<Cell, int> counts;
  for (const MapMatch& match : matches) ++counts[cell_of(match.q_map, config.cell_m)];
  for (MapMatch& match : matches) {
    const int count = counts.at(cell_of(match.q_map, config.cell_m));
    match.sigma_m *= std::sqrt(std::max(1.0, count / config.matches_per_cell));
  }
}

// `nearest_to(landmark, radius_m)` is LaserMap::nearest() of its position.
template <typename Nearest>
Association associate_by(const Nearest& nearest_to,
                         const std::vector<WindowLandmark>& landmarks,
                         const LaserMap& map,
                         double gate_m,
                         const AssociationConfig& config) {
  Association result;
  const double spacing = map.info().resolution_m;
  for (const WindowLandmark& landmark : landmarks) {
    const double own_sigma = max_sigma(landmark.covariance);
    if (!(own_sigma <= config.max_landmark_sigma_m)) continue;
    ++result.eligible;
    const double search_radius_m =
        std::hypot(gate_m, config.gate_sigmas * std::hypot(own_sigma, spacing));
    const auto nearest = nearest_to(landmark, std::max(search_radius_m, config.coverage_radius_m));
    if (!nearest) continue;
    ++result.covered;
    const MapMatch match =
        make_match(landmark, nearest->index, map.point(nearest->index), gate_m, config);
    if (is_within_gate(match, gate_m, spacing, config.gate_sigmas)) {
      result.matches.push_back(match);
      if (match.is_level) ++result.level;
    } else if (is_occluded(match, gate_m)) {
      ++result.occluded;
      if (match.is_level) ++result.below_ground;
    }
  }
  cap_information(result.matches, config);
  return result;
}

}  // namespace

Association associate(const std::vector<WindowLandmark>& landmarks,
                      const LaserMap& map,
                      double gate_m,
                      const AssociationConfig& config) {
  const auto nearest_to = [&map](const WindowLandmark& landmark, double radius_m) {
    return map.nearest(landmark.p_map, radius_m);
  };
  return associate_by(nearest_to, landmarks, map, gate_m, config);
}

Association associate(const std::vector<WindowLandmark>& landmarks,
                      const LaserMap& map,
                      double gate_m,
                      const AssociationConfig& config,
                      NearestNeighborCache& cache) {
  const auto nearest_to = [&cache](const WindowLandmark& landmark, double radius_m) {
    return cache.nearest(landmark.id, landmark.p_map, radius_m);
  };
  return associate_by(nearest_to, landmarks, map, gate_m, config);
}

double residual(const MapMatch& match, const Eigen::Vector3d& p_map) {
  const Eigen::Vector3d d = p_map - match.q_map;
  return match.is_planar ? match.normal.dot(d) : d.norm();
}

AssociationConfig read_association_config(ConfigReader section) {
  return {.plane_sigma_m = section.positive("plane_sigma_m"),
          .point_sigma_m = section.positive("point_sigma_m"),
          .min_planarity = section.positive("min_planarity"),
          .level_from = section.number("level_from", 0.0, 1.0),
          .max_landmark_sigma_m = section.positive("max_landmark_sigma_m"),
          .gate_sigmas = section.positive("gate_sigmas"),
          .coverage_radius_m = section.positive("coverage_radius_m"),
          .cell_m = section.positive("cell_m"),
          .matches_per_cell = section.positive("matches_per_cell")};
}

}  // namespace fleetloc
