#include "cloud/localizer/shift_profile.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Eigenvalues>

#include "cloud/localizer/evenly.hpp"

namespace fleetloc {
namespace {

constexpr double kMaxMatchScore = 9.0;  // of a landmark: three sigmas, squared

double variance_of(const MapMatch& match) {
  const Eigen::Vector3d& n = match.normal;
  return match.sigma_m * match.sigma_m + n.dot(match.landmark.covariance * n);
}

std::vector<MapMatch> informative_matches(std::vector<WindowLandmark> landmarks,
                                          const Eigen::Vector2d& shift_m,
                                          const LaserMap& map,
                                          double gate_m,
                                          const AssociationConfig& config) {
  for (WindowLandmark& landmark : landmarks) {
    landmark.p_map.head<2>() += shift_m;
    landmark.viewpoint_map.head<2>() += shift_m;
  }
  std::vector<MapMatch> matches = associate(landmarks, map, gate_m, config).matches;
  std::erase_if(matches, [](const MapMatch& match) { return match.is_level; });
  return matches;
}

// The larger, the better the window fits.
double fit_score(const std::vector<MapMatch>& matches) {
  double sum = 0.0;
  for (const MapMatch& match : matches) {
    const double error = residual(match, match.landmark.p_map);
    sum += kMaxMatchScore - std::min(error * error / variance_of(match), kMaxMatchScore);
  }
  return sum;
}

Eigen::Matrix2d shift_information(const std::vector<MapMatch>& matches) {
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
  for (const MapMatch& match : matches) {
    const Eigen::Vector2d n = match.normal.head<2>();
    information += n * n.transpose() / variance_of(match);
  }
  return information;
}

// Second moment of shifts about zero, by their scores.
double second_moment(const std::vector<std::pair<double, double>>& shifts_and_scores,
                     double temperature) {
  double best = shifts_and_scores.front().second;
  for (const auto& [shift_m, score] : shifts_and_scores) best = std::max(best, score);
  double odds_of_all = 0.0;
  double sum = 0.0;
  for (const auto& [shift_m, score] : shifts_and_scores) {
    const double odds = std::exp((score - best) / temperature);
    odds_of_all += odds;
    sum += odds * shift_m * shift_m;
  }
  return sum / odds_of_all;
}

// By how much a match has drawn a landmark, to first order: at the optimum the robot's observations
// pull as much as the map does.
Eigen::Vector3d pull(const MapMatch& match, const WindowLandmark& landmark, double map_kernel) {
  const Eigen::Vector3d d = landmark.p_map - match.q_map;
  const double sigma_m = match.sigma_m * match.widening;
  const double sigmas = residual(match, landmark.p_map) / (map_kernel * sigma_m);
  const double weight = 1.0 / ((1.0 + sigmas * sigmas) * sigma_m * sigma_m);
  const Eigen::Vector3d off = match.is_planar ? match.normal * match.normal.dot(d) : d;
  return weight * landmark.covariance * off;
}

}  // namespace

std::vector<WindowLandmark> seen_without_map(std::vector<WindowLandmark> landmarks,
                                             const std::vector<MapMatch>& matches,
                                             double map_kernel) {
  std::vector<WindowLandmark> result;
  auto match = matches.begin();
  for (WindowLandmark& landmark : landmarks) {
    while (match != matches.end() && match->landmark.id < landmark.id) ++match;
    const bool is_matched = match != matches.end() && match->landmark.id == landmark.id;
    if (is_matched && match->is_level) continue;
    if (is_matched) landmark.p_map += pull(*match, landmark, map_kernel);
    result.push_back(landmark);
  }
  return result;
}

ShiftProfile::ShiftProfile(const std::vector<WindowLandmark>& landmarks,
                           const LaserMap& map,
                           double gate_m,
                           const AssociationConfig& association,
                           const ShiftProfileConfig& config,
                           double temperature) {
  AssociationConfig only_matches = association;
  only_matches.coverage_radius_m = 0.0;  // nothing else is asked for
  const std::vector<WindowLandmark> some = evenly(landmarks, config.max_landmarks);
  const auto matches_at = [&](const Eigen::Vector2d& shift_m) {
    return informative_matches(some, shift_m, map, gate_m, only_matches);
  };
  const std::vector<MapMatch> here = matches_at(Eigen::Vector2d::Zero());
  const double score_here = fit_score(here);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(shift_information(here));
  for (int i = 0; i < 2; ++i) {
    Axis& axis = axes_[static_cast<std::size_t>(i)];
    axis.direction_map = eigen.eigenvectors().col(i);
    std::vector<std::pair<double, double>> sampled{{0.0, score_here}};
    std::vector<std::pair<double, double>> quadratic{{0.0, 0.0}};
    for (int step = -config.steps; step <= config.steps; ++step) {
      if (step == 0) continue;
      const double shift_m = config.step_m * step;
      sampled.emplace_back(shift_m, fit_score(matches_at(shift_m * axis.direction_map)));
      quadratic.emplace_back(shift_m, -eigen.eigenvalues()(i) * shift_m * shift_m);
    }
    const double more = second_moment(sampled, temperature) - second_moment(quadratic, temperature);
    axis.excess_m2 = std::max(more, 0.0);
  }
}

Eigen::Matrix2d ShiftProfile::excess() const {
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  for (const Axis& axis : axes_) {
    covariance += axis.excess_m2 * axis.direction_map * axis.direction_map.transpose();
  }
  return covariance;
}

// Along an axis of which they tell with the information I, the variance 1 / I becomes 1 / I +
// excess.
void ShiftProfile::widen(std::vector<MapMatch>& matches) const {
  const Eigen::Matrix2d information = shift_information(matches);
  Eigen::Matrix3d factor = Eigen::Matrix3d::Identity();
  for (const Axis& axis : axes_) {
    const double known = axis.direction_map.dot(information * axis.direction_map);
    factor.topLeftCorner<2, 2>() +=
        known * axis.excess_m2 * axis.direction_map * axis.direction_map.transpose();
  }
  for (MapMatch& match : matches) {
    const double along = match.is_planar ? match.normal.dot(factor * match.normal)
                                         : factor.topLeftCorner<2, 2>().trace() / 2.0;
    match.widening *= std::sqrt(along);
  }
}

ShiftProfileConfig read_shift_profile_config(ConfigReader section) {
  return {.is_used = section.get<bool>("is_used"),
          .step_m = section.positive("step_m"),
          .steps = section.integer("steps", 1, 100),
          .found_steps = section.integer("found_steps", 1, 100),
          .max_landmarks = section.integer("max_landmarks", 10, 10000)};
}

}  // namespace fleetloc
