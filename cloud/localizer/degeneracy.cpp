#include "cloud/localizer/degeneracy.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Eigenvalues>

#include "shared/core/percentile.hpp"
#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

constexpr double kMinLever = 0.1;         // [m]
constexpr double kMinInformation = 1e-6;  // [1/m^2]

}  // namespace

double lever(const std::vector<Eigen::Vector3d>& p_map, const Eigen::Vector3d& center_map) {
  std::vector<double> distances;
  distances.reserve(p_map.size());
  for (const Eigen::Vector3d& p : p_map) distances.push_back((p - center_map).norm());
  return std::max(percentile(std::move(distances), 0.5).value_or(0.0), kMinLever);
}

namespace {

WindowMotion motion_about(const std::vector<MapMatch>& matches) {
  WindowMotion motion;
  std::vector<Eigen::Vector3d> positions;
  positions.reserve(matches.size());
  for (const MapMatch& match : matches) positions.push_back(match.landmark.p_map);
  for (const Eigen::Vector3d& p_map : positions) motion.center_map += p_map;
  motion.center_map /= static_cast<double>(positions.size());
  motion.lever_m = lever(positions, motion.center_map);
  return motion;
}

}  // namespace

Matrix6d WindowMotion::J_body_motion(const Pose& T_map_body) const {
  const Eigen::Matrix3d R_body_map = T_map_body.R.toRotationMatrix().transpose();
  Matrix6d J;
  J << R_body_map / lever_m, Eigen::Matrix3d::Zero(),
      -R_body_map * hat(T_map_body.p - center_map) / lever_m, R_body_map;
  return J;
}

Vector6d WindowMotion::gradient(const Eigen::Vector3d& direction_map,
                                const Eigen::Vector3d& p_map) const {
  const Eigen::Vector3d arm = (p_map - center_map) / lever_m;
  Vector6d result;
  result << arm.cross(direction_map), direction_map;
  return result;
}

WeakDirections MapConstraint::weaker_than(double sigma_m) const {
  return directions.leftCols((sigmas_m.array() > sigma_m).count());
}

MapConstraint analyze_map_constraint(const std::vector<MapMatch>& matches,
                                     double normal_sigma_rad) {
  MapConstraint result;
  if (matches.empty()) return result;
  result.motion = motion_about(matches);
  Matrix6d information = Matrix6d::Zero();
  double spurious = 0.0;
  for (const MapMatch& match : matches) {
    const Eigen::Vector3d& n = match.normal;
    const Vector6d gradient = result.motion.gradient(n, match.landmark.p_map);
    const double weight =
        1.0 / (match.sigma_m * match.sigma_m + n.dot(match.landmark.covariance * n));
    information += weight * gradient * gradient.transpose();
    spurious += weight * normal_sigma_rad * normal_sigma_rad;
  }
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(information);
  for (int i = 0; i < 6; ++i) {
    const double honest = std::max(eigen.eigenvalues()(i) - spurious, kMinInformation);
    result.sigmas_m(i) = 1.0 / std::sqrt(honest);
  }
  result.directions = eigen.eigenvectors();
  return result;
}

DegeneracyConfig read_degeneracy_config(ConfigReader section) {
  return {.weak_sigma_m = section.positive("weak_sigma_m"),
          .start_weak_sigma_m = section.positive("start_weak_sigma_m"),
          .normal_sigma_rad = section.positive("normal_sigma_rad")};
}

}  // namespace fleetloc
