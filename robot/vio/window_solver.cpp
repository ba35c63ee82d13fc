#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include <ceres/problem.h>
#include <ceres/solver.h>

#include "robot/inertial/scaled_cholesky.hpp"
#include "robot/vio/gauge_factor.hpp"
#include "robot/vio/window_graph.hpp"

namespace fleetloc {
namespace {

// The kernel's width is for three residuals; the norm of six of the same size is larger by this
// factor.
const double kPoseKernel = std::sqrt(2.0);

GaugeFactor gauge_factor(const GraphKeyframe& oldest) {
  return GaugeFactor(pose_from(oldest.pose.data()),
                     oldest.first_pose ? &*oldest.first_pose : nullptr);
}

ceres::Problem::Options problem_options() {
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;
  return options;
}

ceres::Solver::Options solver_options(int iterations) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.num_threads = 1;
  options.max_num_iterations = iterations;
  options.max_solver_time_in_seconds = 1e9;
  options.function_tolerance = 1e-5;
  options.logging_type = ceres::SILENT;
  return options;
}

// A copy of all unknowns in one contiguous block, in a fixed order. Ceres orders what it eliminates
// by address, so that the sums of a run, and their rounding, would otherwise depend on the heap.
class ContiguousStates {
 public:
  explicit ContiguousStates(WindowGraph& graph) {
    for (auto& [id, landmark] : graph.landmarks) {
      if (landmark.is_active()) {
        add(landmark.p_odom.data(), landmark.p_odom.size());
      }
    }
    landmarks_ = blocks_.size();
    for (GraphKeyframe& keyframe : graph.keyframes) {
      add(keyframe.pose.data(), keyframe.pose.size());
      add(keyframe.speed_bias.data(), keyframe.speed_bias.size());
    }
    for (const Block& block : blocks_) {
      std::copy_n(block.original, block.size, values_.data() + block.offset);
    }
  }

  void add_to(ceres::Problem& problem,
              ceres::Manifold* pose_manifold,
              ceres::ParameterBlockOrdering& ordering) {
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      double* copy = values_.data() + blocks_[i].offset;
      problem.AddParameterBlock(
          copy,
          static_cast<int>(blocks_[i].size),
          blocks_[i].size == PoseParameters{}.size() ? pose_manifold : nullptr);
      ordering.AddElementToGroup(copy, i < landmarks_ ? 0 : 1);
    }
  }

  std::vector<double*> copies_of(const std::vector<const double*>& originals) {
    std::vector<double*> copies;
    copies.reserve(originals.size());
    for (const double* original : originals) {
      copies.push_back(values_.data() + offset_.at(original));
    }
    return copies;
  }

  void write_back() const {
    for (const Block& block : blocks_) {
      std::copy_n(values_.data() + block.offset, block.size, block.original);
    }
  }

 private:
  struct Block {
    double* original = nullptr;
    std::size_t size = 0;
    std::size_t offset = 0;
  };
  void add(double* original, std::size_t size) {
    offset_[original] = values_.size();
    blocks_.push_back({original, size, values_.size()});
    values_.resize(values_.size() + size);
  }

  std::vector<double> values_;
  std::vector<Block> blocks_;
  std::size_t landmarks_ = 0;                              // of the blocks, the first ones
  std::unordered_map<const double*, std::size_t> offset_;  // looked up only
};

double squared_error(const GraphFactor& factor) {
  Eigen::Vector3d residual = Eigen::Vector3d::Zero();  // of two rows if mono
  factor.cost->Evaluate(factor.parameters.data(), residual.data(), nullptr);
  return residual.squaredNorm();
}

void forget_unseen_landmarks(WindowGraph& graph) {
  std::erase_if(graph.landmarks, [](const auto& item) { return item.second.observations == 0; });
}

void forget_observation(WindowGraph& graph, GraphKeyframe& keyframe, LandmarkId id) {
  std::erase_if(keyframe.observations,
                [id](const StereoObservation& seen) { return seen.landmark == id; });
  --graph.landmarks.at(id).observations;
}

}  // namespace

WindowDiagnostics optimize(WindowGraph& graph, const SlidingWindow::Config& config) {
  relinearize_preintegrations(graph);
  std::vector<GraphFactor> inertial = inertial_factors(graph);
  std::vector<VisualFactor> visual = visual_factors(graph, config.noise.pixel_sigma);
  const std::vector<GraphFactor> corrections = correction_factors(graph);
  GaugeFactor gauge = gauge_factor(graph.keyframes.front());
  PoseManifold manifold;
  ceres::HuberLoss huber(config.huber_sigmas);
  ceres::HuberLoss pose_huber(kPoseKernel * config.huber_sigmas);

  ContiguousStates states(graph);
  ceres::Problem problem(problem_options());
  ceres::Solver::Options options = solver_options(config.iterations);
  options.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  states.add_to(problem, &manifold, *options.linear_solver_ordering);
  const auto add = [&](ceres::CostFunction& cost,
                       ceres::LossFunction* loss,
                       const std::vector<const double*>& parameters) {
    problem.AddResidualBlock(&cost, loss, states.copies_of(parameters));
  };
  add(gauge, nullptr, {graph.keyframes.front().pose.data()});
  if (graph.prior != nullptr) {
    add(*graph.prior, nullptr, block_of(*graph.prior).parameters);
  }
  for (const GraphFactor& factor : inertial) {
    add(*factor.cost, nullptr, factor.parameters);
  }
  for (const VisualFactor& factor : visual) {
    add(*factor.factor.cost, &huber, factor.factor.parameters);
  }
  for (const GraphFactor& factor : corrections) {
    const bool e_rt = factor.cost->num_residuals() == 6;
    add(*factor.cost, e_rt ? &pose_huber : &huber, factor.parameters);
  }
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  states.write_back();

  WindowDiagnostics diagnostics;
  diagnostics.initial_cost = summary.initial_cost;
  diagnostics.final_cost = summary.final_cost;
  diagnostics.iterations = static_cast<int>(summary.iterations.size());
  diagnostics.converged = summary.IsSolutionUsable();
  diagnostics.observations = static_cast<int>(visual.size());
  return diagnostics;
}

int remove_outliers(WindowGraph& graph, const SlidingWindow::Config& config) {
  const double limit = config.outlier_sigmas * config.outlier_sigmas;
  int removed = 0;
  for (const VisualFactor& visual : visual_factors(graph, config.noise.pixel_sigma)) {
    if (squared_error(visual.factor) > limit) {
      forget_observation(graph, graph.keyframes[visual.keyframe], visual.landmark);
      ++removed;
    }
  }
  forget_unseen_landmarks(graph);
  drop_stale_corrections(graph);
  return removed;
}

OdometryMarginal odometry_marginal(WindowGraph& graph, const SlidingWindow::Config& config) {
  const std::vector<GraphFactor> inertial = inertial_factors(graph);
  const std::vector<VisualFactor> visual = visual_factors(graph, config.noise.pixel_sigma);
  const GaugeFactor gauge = gauge_factor(graph.keyframes.front());
  const ceres::HuberLoss huber(config.huber_sigmas);
  std::vector<ResidualBlock> blocks{{&gauge, nullptr, {graph.keyframes.front().pose.data()}}};
  if (graph.prior != nullptr) {
    blocks.push_back(block_of(*graph.prior));
  }
  for (const GraphFactor& factor : inertial) {
    blocks.push_back(block_of(factor));
  }
  for (const VisualFactor& factor : visual) {
    blocks.push_back(block_of(factor.factor, &huber));
  }
  std::vector<ParameterBlock> kept;
  for (const GraphKeyframe& keyframe : graph.keyframes) {
    kept.push_back({keyframe.pose.data(), 6});
    kept.push_back({keyframe.speed_bias.data(), 9});
  }
  std::vector<const double*> points;
  for (const auto& [id, landmark] : graph.landmarks) {
    if (landmark.is_active()) {
      points.push_back(landmark.p_odom.data());
    }
  }
  const NormalEquations system = schur_complement(blocks, kept, points);
  const ScaledCholesky cholesky(system.H);
  if (!cholesky.regular()) {  // NaN fails every check: diverged
    constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
    return {Eigen::MatrixXd::Constant(system.H.rows(), system.H.cols(), kUnknown),
            Eigen::VectorXd::Constant(system.H.rows(), kUnknown)};
  }
  return {cholesky.inverse(), -cholesky.solve(system.g)};
}

}  // namespace fleetloc
