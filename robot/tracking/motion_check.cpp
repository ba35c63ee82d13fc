#include "robot/tracking/motion_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <Eigen/Cholesky>

#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

constexpr std::uint32_t kSeed = 1;
constexpr int kIterations = 4;
constexpr double kConfidence = 0.999;

/// Inputs of all steps below. Indices point into `correspondences`.
struct Problem {
  const std::vector<Correspondence>& correspondences;
  const RectifiedStereo& stereo;
  const Pose& prediction;
  const MotionCheckConfig& config;
  std::vector<std::size_t> with_depth;
};

Eigen::Vector3d ray(const Problem& problem, const Eigen::Vector2d& pixel) {
  return ((pixel - problem.stereo.center_px) / problem.stereo.focal_px).homogeneous();
}

Eigen::Vector2d pixel(const Problem& problem, const Eigen::Vector3d& p_cam) {
  return problem.stereo.center_px + p_cam.head<2>() * (problem.stereo.focal_px / p_cam.z());
}

Eigen::Vector3d point(const Problem& problem, const Correspondence& c) {
  return ray(problem, c.previous) *
         (problem.stereo.focal_px * problem.stereo.baseline_m / c.disparity);
}

/// From the current pixel to the one predicted by the motion; infinite behind the camera.
double distance_of_point(const Problem& problem, const Correspondence& c, const Pose& T) {
  const Eigen::Vector3d moved = T * point(problem, c);
  if (moved.z() <= 0.0) return std::numeric_limits<double>::infinity();
  return (pixel(problem, moved) - c.current).norm();
}

double distance_to_segment(const Eigen::Vector2d& x,
                           const Eigen::Vector2d& a,
                           const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = b - a;
  const double length_squared = along.squaredNorm();
  if (length_squared < 1e-12) return (x - a).norm();
  const double share = std::clamp((x - a).dot(along) / length_squared, 0.0, 1.0);
  return (x - a - share * along).norm();
}

/// From the current pixel to the pixels of all depths from infinity to nearest_m.
double distance_of_ray(const Problem& problem, const Correspondence& c, const Pose& T) {
  const Eigen::Vector3d far = T.R * ray(problem, c.previous);
  if (far.z() <= 0.0) return std::numeric_limits<double>::infinity();
  double inverse_depth = 1.0 / problem.config.nearest_m;
  if (T.p.z() < 0.0) {  // the point comes nearer: it must stay in front
    inverse_depth = std::min(inverse_depth, -0.9 * far.z() / T.p.z());
  }
  const Eigen::Vector3d near = far + inverse_depth * T.p;
  return distance_to_segment(c.current, pixel(problem, far), pixel(problem, near));
}

double distance(const Problem& problem, const Correspondence& c, const Pose& T, bool use_depth) {
  return use_depth && c.disparity > 0.0 ? distance_of_point(problem, c, T)
                                        : distance_of_ray(problem, c, T);
}

/// Gauss-Newton for the motion of points with depth, from `T`, with the prediction as weak prior.
Pose refine(const Problem& problem, const std::vector<std::size_t>& points, Pose T) {
  const double focal = problem.stereo.focal_px;
  const double rotation_weight = std::pow(problem.config.rotation_sigma_rad, -2);
  const double translation_weight = std::pow(problem.config.translation_sigma_m, -2);
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Matrix6d H = Matrix6d::Zero();
    H.diagonal() << Eigen::Vector3d::Constant(rotation_weight),
        Eigen::Vector3d::Constant(translation_weight);
    Vector6d g;
    g << rotation_weight * log_so3(problem.prediction.R.conjugate() * T.R),
        translation_weight * (T.R.conjugate() * (T.p - problem.prediction.p));
    for (const auto index : points) {
      const Correspondence& c = problem.correspondences[index];
      const Eigen::Vector3d p_previous = point(problem, c);
      const Eigen::Vector3d p = T * p_previous;
      if (p.z() <= 0.0) continue;
      const Eigen::Vector2d error = pixel(problem, p) - c.current;
      const double weight =  // Huber
          std::min(1.0, problem.config.inlier_px / std::max(error.norm(), 1e-9));
      Eigen::Matrix<double, 2, 3> J_pixel_p;
      J_pixel_p << 1.0, 0.0, -p.x() / p.z(), 0.0, 1.0, -p.y() / p.z();
      J_pixel_p *= focal / p.z();
      const Eigen::Matrix<double, 2, 3> J_translation = J_pixel_p * T.R.toRotationMatrix();
      Eigen::Matrix<double, 2, 6> J;
      J << -J_translation * hat(p_previous), J_translation;
      H += weight * J.transpose() * J;
      g += weight * J.transpose() * error;
    }
    const Vector6d step = -H.ldlt().solve(g);
    T.p += T.R * step.tail<3>();
    T.R = (T.R * exp_so3(step.head<3>())).normalized();
    if (step.norm() < 1e-6) break;
  }
  return T;
}

/// Direction of the translation from two points, given the rotation: each point's epipolar plane
/// holds it.
Pose translation_from_two(const Problem& problem, std::size_t first, std::size_t second) {
  const auto normal = [&](std::size_t index) -> Eigen::Vector3d {
    const Correspondence& c = problem.correspondences[index];
    const Eigen::Vector3d before = problem.prediction.R * ray(problem, c.previous);
    return before.cross(ray(problem, c.current));
  };
  Pose T = problem.prediction;
  const Eigen::Vector3d direction = normal(first).cross(normal(second));
  const double length = direction.norm();
  T.p = length > 1e-15 ? Eigen::Vector3d(direction / length) : Eigen::Vector3d::Zero();
  return T;
}

std::vector<std::size_t> inliers_with_depth(const Problem& problem, const Pose& T) {
  std::vector<std::size_t> inliers;
  for (const auto index : problem.with_depth) {
    if (distance_of_point(problem, problem.correspondences[index], T) < problem.config.inlier_px) {
      inliers.push_back(index);
    }
  }
  return inliers;
}

/// Hypotheses after which one of only inliers was drawn with kConfidence.
int hypotheses_needed(std::size_t inliers, std::size_t points, int sample, int max) {
  const double share = static_cast<double>(inliers) / static_cast<double>(points);
  const double good = std::pow(share, sample);
  if (good > kConfidence) return 1;
  if (good < 1e-6) return max;
  const double needed = std::log(1.0 - kConfidence) / std::log(1.0 - good);
  return static_cast<int>(std::min(std::ceil(needed), static_cast<double>(max)));
}

/// The first hypothesis is that most points are good; then three points at a time.
Pose estimate_motion(const Problem& problem) {
  const std::size_t count = problem.with_depth.size();
  Pose best = refine(problem, problem.with_depth, problem.prediction);
  auto best_inliers = inliers_with_depth(problem, best);
  std::mt19937 random(kSeed);
  int needed = hypotheses_needed(best_inliers.size(), count, 3, problem.config.hypotheses);
  for (int i = 1; i < needed; ++i) {
    std::vector<std::size_t> sample(3);
    for (auto& index : sample) index = problem.with_depth[random() % count];
    const Pose T = refine(problem, sample, problem.prediction);
    auto inliers = inliers_with_depth(problem, T);
    if (inliers.size() <= best_inliers.size()) continue;
    best = T;
    best_inliers = std::move(inliers);
    needed = hypotheses_needed(best_inliers.size(), count, 3, problem.config.hypotheses);
  }
  best = refine(problem, best_inliers, best);
  return refine(problem, inliers_with_depth(problem, best), best);
}

Pose search_direction(const Problem& problem) {
  const std::size_t count = problem.correspondences.size();
  Pose best = problem.prediction;
  std::size_t max_inliers = 0;
  if (count < 2) return best;
  std::mt19937 random(kSeed);
  int needed = problem.config.hypotheses;
  for (int i = 0; i < needed; ++i) {
    Pose T = translation_from_two(problem, random() % count, random() % count);
    for (int sign = 0; sign < 2; ++sign, T.p = -T.p) {
      const auto inliers = static_cast<std::size_t>(
          std::count_if(problem.correspondences.begin(),
                        problem.correspondences.end(),
                        [&](const Correspondence& c) {
                          return distance_of_ray(problem, c, T) < problem.config.inlier_px;
                        }));
      if (inliers <= max_inliers) continue;
      max_inliers = inliers;
      best = T;
    }
    needed = hypotheses_needed(max_inliers, count, 2, problem.config.hypotheses);
  }
  return best;
}

}  // namespace

MotionCheckConfig read_motion_check_config(ConfigReader section) {
  return {.inlier_px = section.positive("inlier_px"),
          .hypotheses = section.integer("hypotheses", 1, 10000),
          .min_points = section.integer("min_points", 3, 1000),
          .nearest_m = section.positive("nearest_m"),
          .rotation_sigma_rad = section.positive("rotation_sigma_rad"),
          .translation_sigma_m = section.positive("translation_sigma_m")};
}

RigidMotion estimate_rigid_motion(const std::vector<Correspondence>& correspondences,
                                  const RectifiedStereo& stereo,
                                  const Pose& predicted_T_current_previous,
                                  const MotionCheckConfig& config) {
  Problem problem{correspondences, stereo, predicted_T_current_previous, config, {}};
  for (std::size_t i = 0; i < correspondences.size(); ++i) {
    if (correspondences[i].disparity > 0.0) problem.with_depth.push_back(i);
  }
  RigidMotion result;
  result.has_translation = problem.with_depth.size() >= static_cast<std::size_t>(config.min_points);
  const Pose T = result.has_translation ? estimate_motion(problem) : search_direction(problem);
  for (const auto& c : correspondences) {
    result.distances_px.push_back(distance(problem, c, T, result.has_translation));
    result.inliers.push_back(result.distances_px.back() < config.inlier_px);
  }
  result.T_current_previous = T;
  return result;
}

}  // namespace fleetloc
