#include "robot_window.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <ceres/normal_prior.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include "shared/factors/relative_pose_factor.hpp"
#include "shared/factors/reprojection_factor.hpp"

namespace fleetloc {
namespace {

KeyframeId id_of(int keyframe) {
  return KeyframeId{static_cast<std::uint32_t>(keyframe)};
}

PointParameters to_parameters(const Eigen::Vector3d& p) {
  return {p.x(), p.y(), p.z()};
}

}  // namespace

RobotWindow::RobotWindow(const SimulatedSession& robot, int newest, int keyframes)
    : robot_(robot), anchor_(id_of(newest)) {
  const int oldest = newest + 1 - keyframes;
  for (int i = oldest; i <= newest; ++i) poses_[id_of(i)] = to_parameters(robot.truth(i));
  for (int i = oldest; i <= newest; ++i) add_measurements(i);
}

void RobotWindow::add_measurements(int keyframe) {
  const Submap submap = robot_.submap(keyframe);
  for (const VirtualEdge& edge : submap.edges) {
    if (!poses_.contains(edge.from)) continue;
    add(std::make_unique<RelativePoseFactor>(edge.T_from_to, edge.information),
        {poses_.at(edge.from).data(), poses_.at(edge.to).data()});
  }
  for (const StereoObservation& seen : submap.keyframes[0].observations) {
    if (seen.disparity <= 0.0) continue;
    const auto [place, is_new] = points_.try_emplace(seen.landmark);
    if (is_new) place->second.p = to_parameters(robot_.run().landmark(seen.landmark));
    add(std::make_unique<StereoReprojectionFactor>(seen, robot_.run().stereo(), StereoNoise{0.7}),
        {poses_.at(id_of(keyframe)).data(), place->second.p.data()});
  }
}

void RobotWindow::add_correction(const Correction& correction) {
  for (const auto& pair : correction.relative_poses) {
    add(std::make_unique<RelativePoseFactor>(pair.T_from_to, pair.information),
        {poses_.at(pair.from).data(), poses_.at(pair.to).data()});
  }
  const Pose T_map_anchor = pose(correction.anchor);  // held
  for (const auto& landmark : correction.landmarks) {
    const auto place = points_.find(landmark.id);
    if (place == points_.end()) continue;
    const Eigen::LDLT<Eigen::Matrix3d> ldlt(landmark.information);
    const Eigen::Matrix3d L = ldlt.transpositionsP().transpose() * Eigen::Matrix3d(ldlt.matrixL()) *
                              ldlt.vectorD().cwiseMax(0.0).cwiseSqrt().asDiagonal();
    const Eigen::MatrixXd A = L.transpose() * T_map_anchor.R.toRotationMatrix().transpose();
    const Eigen::VectorXd p_map = T_map_anchor * landmark.p_anchor;
    add(std::make_unique<ceres::NormalPrior>(A, p_map), {place->second.p.data()});
  }
}

void RobotWindow::add(std::unique_ptr<ceres::CostFunction> cost, std::vector<double*> parameters) {
  blocks_.push_back({cost.get(), nullptr, {parameters.begin(), parameters.end()}});
  costs_.push_back(std::move(cost));
}

void RobotWindow::solve(const Correction& correction) {
  add_correction(correction);
  PoseManifold manifold;
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(options);
  for (auto& [id, values] : poses_) problem.AddParameterBlock(values.data(), 7, &manifold);
  problem.SetParameterBlockConstant(poses_.at(anchor_).data());
  for (const ResidualBlock& block : blocks_) {
    std::vector<double*> parameters;
    for (const double* values : block.parameters) parameters.push_back(const_cast<double*>(values));
    // The problem takes costs by mutable pointer, although it only evaluates them.
    problem.AddResidualBlock(const_cast<ceres::CostFunction*>(block.cost), nullptr, parameters);
  }
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::SPARSE_SCHUR;
  solver.num_threads = 1;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  linearize();
}

void RobotWindow::linearize() {
  std::vector<ParameterBlock> kept;
  for (const auto& [id, values] : poses_) {
    if (id != anchor_) kept.push_back({values.data(), 6});
  }
  std::vector<const double*> points;
  for (const auto& [id, landmark] : points_) points.push_back(landmark.p.data());
  NormalEquationsBuilder builder(kept, points);
  for (const ResidualBlock& block : blocks_) builder.add(block);
  information_ = builder.reduced().H;
  const Eigen::MatrixXd covariance = information_.inverse();
  auto point = builder.points().begin();
  for (auto& [id, landmark] : points_) {
    const Eigen::Matrix3d own = point->H.inverse();
    landmark.covariance = own;
    for (const auto& a : point->couplings) {
      for (const auto& b : point->couplings) {
        landmark.covariance +=
            own * a.H.transpose() * covariance.block<6, 6>(6L * a.kept, 6L * b.kept) * b.H * own;
      }
    }
    ++point;
  }
}

Pose RobotWindow::pose(KeyframeId id) const {
  return pose_from(poses_.at(id).data());
}

Vector6d RobotWindow::error_of(KeyframeId id) const {
  return local_coordinates(pose(id), robot_.truth(id));
}

double RobotWindow::pose_nees() const {
  Eigen::VectorXd errors(information_.rows());
  Eigen::Index row = 0;
  for (const auto& [id, values] : poses_) {
    if (id == anchor_) continue;
    errors.segment<6>(row) = error_of(id);
    row += 6;
  }
  return errors.dot(information_ * errors) / static_cast<double>(errors.size());
}

double RobotWindow::oldest_nees() const {
  const Eigen::MatrixXd covariance = information_.inverse();
  const Vector6d error = error_of(poses_.begin()->first);
  return error.dot(covariance.topLeftCorner<6, 6>().ldlt().solve(error)) / 6.0;
}

Eigen::Vector3d RobotWindow::error(LandmarkId id) const {
  const Eigen::Vector3d p_map = Eigen::Map<const Eigen::Vector3d>(points_.at(id).p.data());
  return pose(anchor_).R.conjugate() * (p_map - robot_.run().landmark(id));
}

double RobotWindow::nees(LandmarkId id) const {
  const Eigen::Vector3d error_map = pose(anchor_).R * error(id);
  return error_map.dot(points_.at(id).covariance.ldlt().solve(error_map)) / 3.0;
}

}  // namespace fleetloc
