#include <algorithm>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <ceres/solver.h>

#include "cloud/localizer/window_problem.hpp"
#include "shared/factors/normal_equations.hpp"
#include "shared/factors/point_factors.hpp"
#include "shared/factors/relative_decrease_termination.hpp"
#include "shared/factors/relative_pose_factor.hpp"

namespace fleetloc {
namespace {

constexpr double kSingular = 1e-9;  // information of a landmark [1/m^2]

bool is_same(const MapMatch& a, const MapMatch& b) {
  return a.map_point == b.map_point && a.sigma_m == b.sigma_m && a.widening == b.widening &&
         a.is_planar == b.is_planar;
}

}  // namespace

void WindowProblem::set_matches(const std::vector<MapMatch>& matches) {
  auto match = matches.begin();
  for (auto& [id, landmark] : landmarks_) {
    while (match != matches.end() && match->landmark.id < id) ++match;
    const bool is_matched = match != matches.end() && match->landmark.id == id;
    set_match(landmark, is_matched ? &*match : nullptr);
  }
}

void WindowProblem::set_match(LandmarkNode& landmark, const MapMatch* match) {
  if (landmark.match && match != nullptr && is_same(*landmark.match, *match)) return;
  if (landmark.map_factor != nullptr) {
    problem_.RemoveResidualBlock(std::exchange(landmark.map_factor, nullptr));
  }
  landmark.match.reset();
  if (match == nullptr) return;
  landmark.match = *match;
  const double sigma_m = match->sigma_m * match->widening;
  ceres::CostFunction* factor = nullptr;
  if (match->is_planar) {
    factor = new PointToPlaneFactor(match->q_map, match->normal, sigma_m);
  } else {
    factor = new PointToPointFactor(match->q_map, sigma_m);
  }
  landmark.map_factor = problem_.AddResidualBlock(factor, &map_loss_, landmark.point);
}

void WindowProblem::set_prior(KeyframeId keyframe,
                              const Pose& T_map_body,
                              const Matrix6d& information) {
  clear_prior();
  prior_ = problem_.AddResidualBlock(
      new PosePriorFactor(T_map_body, information), nullptr, keyframes_.at(keyframe).pose);
}

void WindowProblem::clear_prior() {
  if (prior_ != nullptr) problem_.RemoveResidualBlock(std::exchange(prior_, nullptr));
}

void WindowProblem::move(const Pose& T_new_old) {
  for (auto& [id, node] : keyframes_) {
    const PoseParameters moved = to_parameters(T_new_old * pose_from(node.pose));
    std::copy(moved.begin(), moved.end(), node.pose);
  }
  for (auto& [id, node] : landmarks_) {
    Eigen::Map<Eigen::Vector3d> p_map(node.point);
    p_map = T_new_old * Eigen::Vector3d(p_map);
  }
}

WindowProblem::Solved WindowProblem::solve(int max_iterations, double min_decrease) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.num_threads = 1;
  options.max_num_iterations = max_iterations;
  options.jacobi_scaling = false;  // everything is whitened, and in metres and radians
  options.logging_type = ceres::SILENT;
  options.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (const auto& [id, node] : landmarks_) {
    options.linear_solver_ordering->AddElementToGroup(node.point, 0);
  }
  for (const auto& [id, node] : keyframes_) {
    options.linear_solver_ordering->AddElementToGroup(node.pose, 1);
  }
  RelativeDecreaseTermination termination(min_decrease);
  options.callbacks.push_back(&termination);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem_, &summary);
  return {.is_usable = summary.IsSolutionUsable(),
          .iterations = static_cast<int>(summary.iterations.size()) - 1,
          .cost = summary.final_cost};
}

Pose WindowProblem::pose(KeyframeId id) const {
  return pose_from(keyframes_.at(id).pose);
}

std::map<KeyframeId, Pose> WindowProblem::poses() const {
  std::map<KeyframeId, Pose> poses;
  for (const auto& [id, node] : keyframes_) poses[id] = pose_from(node.pose);
  return poses;
}

LandmarkPositions WindowProblem::positions() const {
  LandmarkPositions positions;
  for (const auto& [id, node] : landmarks_) {
    positions.emplace_hint(positions.end(), id, Eigen::Map<const Eigen::Vector3d>(node.point));
  }
  return positions;
}

std::vector<WindowLandmark> WindowProblem::landmarks() const {
  std::map<LandmarkId, WindowLandmark> landmarks;
  for (const auto& [id, node] : landmarks_) {
    landmarks[id].id = id;
    landmarks[id].p_map = Eigen::Map<const Eigen::Vector3d>(node.point);
  }
  for (const auto& [id, keyframe] : keyframes_) {
    const Pose T_map_cam0 = pose_from(keyframe.pose) * stereo_.T_body_cam0;
    const Pose T_cam0_map = inverse(T_map_cam0);
    for (std::size_t i = 0; i < keyframe.factors.size(); ++i) {
      if (keyframe.factors[i] == nullptr) continue;
      const StereoObservation& seen = keyframe.observations[i];
      WindowLandmark& landmark = landmarks.at(seen.landmark);
      landmark.viewpoint_map = T_map_cam0.p;
      landmark.covariance +=
          position_information(seen, stereo_, T_cam0_map, landmark.p_map, keyframe.pixel_sigma_px);
    }
  }
  std::vector<WindowLandmark> result;
  result.reserve(landmarks.size());
  for (auto& [id, landmark] : landmarks) {
    const Eigen::Matrix3d information =
        landmark.covariance + kSingular * Eigen::Matrix3d::Identity();
    landmark.covariance = information.inverse();
    result.push_back(landmark);
  }
  return result;
}

WindowSystem WindowProblem::system() const {
  WindowSystem system;
  std::vector<ParameterBlock> kept;
  for (const auto& [id, node] : keyframes_) {
    system.keyframes.push_back(id);
    system.T_map_body.push_back(pose_from(node.pose));
    kept.push_back({node.pose, 6});
  }
  std::vector<const double*> points;
  for (const auto& [id, node] : landmarks_) points.push_back(node.point);

  NormalEquationsBuilder builder(kept, points);
  for (const ceres::ResidualBlockId factor : robot_factors()) builder.add(block_of(factor));
  system.H_robot = builder.reduced().H;
  for (const auto& [id, node] : landmarks_) {
    system.landmarks.push_back({.id = id,
                                .p_map = Eigen::Map<const Eigen::Vector3d>(node.point),
                                .is_matched = node.map_factor != nullptr,
                                .H_robot = builder.points()[system.landmarks.size()].H,
                                .equations = {}});
  }
  for (const ceres::ResidualBlockId factor : other_factors()) builder.add(block_of(factor));
  system.cholesky.compute(builder.reduced().H);
  for (std::size_t i = 0; i < points.size(); ++i) {
    system.landmarks[i].equations = builder.points()[i];
  }
  return system;
}

std::optional<Matrix6d> WindowProblem::covariance_from(KeyframeId origin,
                                                       KeyframeId keyframe) const {
  if (origin == keyframe) return Matrix6d::Zero();
  return marginal(robot_factors(), keyframe, origin);
}

std::vector<ceres::ResidualBlockId> WindowProblem::robot_factors() const {
  std::vector<ceres::ResidualBlockId> factors;
  for (const auto& [key, edge] : edges_) factors.push_back(edge.factor);
  for (const auto& [id, node] : keyframes_) {
    std::ranges::copy_if(node.factors, std::back_inserter(factors), [](auto id_of_factor) {
      return id_of_factor != nullptr;
    });
  }
  return factors;
}

std::vector<ceres::ResidualBlockId> WindowProblem::other_factors() const {
  std::vector<ceres::ResidualBlockId> factors;
  if (tilt_ != nullptr) factors.push_back(tilt_);
  if (prior_ != nullptr) factors.push_back(prior_);
  for (const auto& [id, node] : landmarks_) {
    if (node.map_factor != nullptr) factors.push_back(node.map_factor);
  }
  return factors;
}

ResidualBlock WindowProblem::block_of(ceres::ResidualBlockId id) const {
  std::vector<double*> parameters;
  problem_.GetParameterBlocksForResidualBlock(id, &parameters);
  return {problem_.GetCostFunctionForResidualBlock(id),
          problem_.GetLossFunctionForResidualBlock(id),
          {parameters.begin(), parameters.end()}};
}

std::optional<Matrix6d> WindowProblem::marginal(const std::vector<ceres::ResidualBlockId>& ids,
                                                KeyframeId keyframe,
                                                std::optional<KeyframeId> fixed) const {
  std::vector<ResidualBlock> blocks;
  blocks.reserve(ids.size());
  for (const ceres::ResidualBlockId id : ids) blocks.push_back(block_of(id));
  std::vector<ParameterBlock> kept;
  Eigen::Index column = 0;
  for (const auto& [id, node] : keyframes_) {
    if (id == keyframe) column = static_cast<Eigen::Index>(kept.size()) * 6;
    if (id != fixed) kept.push_back({node.pose, 6});
  }
  std::vector<const double*> points;
  for (const auto& [id, node] : landmarks_) points.push_back(node.point);

  const NormalEquations system = schur_complement(blocks, kept, points);
  const Eigen::LLT<Eigen::MatrixXd> cholesky(system.H);
  if (cholesky.info() != Eigen::Success) return std::nullopt;
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(system.H.rows(), 6);
  columns.middleRows<6>(column).setIdentity();
  cholesky.matrixL().solveInPlace(columns);
  const Matrix6d covariance = columns.transpose() * columns;
  if (!covariance.allFinite()) return std::nullopt;
  return covariance;
}

}  // namespace fleetloc
