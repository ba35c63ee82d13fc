#include "robot/vio/marginalization.hpp"

#include <random>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "robot/vio/gauge_factor.hpp"
#include "robot/vio/window_graph.hpp"
#include "test/unit/factors/factor_jacobian.hpp"
#include "test/unit/vio/slid_graph.hpp"

namespace fleetloc {
namespace {

Eigen::MatrixXd random_matrix(Eigen::Index rows, Eigen::Index cols, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd M(rows, cols);
  for (Eigen::Index i = 0; i < M.size(); ++i) {
    M(i) = normal(random);
  }
  return M;
}

TEST(WithoutLeading, SolvesTheRestAsTheWholeSystemDoes) {
  const Eigen::MatrixXd A = random_matrix(30, 20, 1);
  NormalEquations all;
  all.H = A.transpose() * A;
  all.g = random_matrix(20, 1, 2);
  const NormalEquations rest = marginalize_leading(all, 8);
  const Eigen::VectorXd expected = all.H.ldlt().solve(all.g).tail(12);
  EXPECT_LT((rest.H.ldlt().solve(rest.g) - expected).norm(), 1e-9);
}

class PriorTest : public testing::Test {
 protected:
  PriorTest() {
    const PoseParameters pose =
        to_parameters(exp_se3((Vector6d() << 0.4, -0.2, 1.1, 1.0, 2.0, -1.0).finished()));
    pose_ = block_of(pose);
    speed_bias_ = {0.1, 0.2, -0.3, 0.01, 0.02, 0.03, 0.1, 0.2, 0.1};
    states_ = {{pose_.data(), Eigen::Map<Eigen::VectorXd>(pose_.data(), 7)},
               {speed_bias_.data(), Eigen::Map<Eigen::VectorXd>(speed_bias_.data(), 9)}};
  }
  std::vector<double> pose_;
  std::vector<double> speed_bias_;
  std::vector<PriorState> states_;
};

TEST_F(PriorTest, HasTheGivenInformationAndGradient) {
  const Eigen::MatrixXd A = random_matrix(30, 15, 3);
  const Eigen::MatrixXd H = A.transpose() * A;
  const Eigen::VectorXd g = random_matrix(15, 1, 4);
  const MarginalizationPrior prior(states_, H, g);
  EXPECT_LT((prior.jacobian().transpose() * prior.jacobian() - H).norm(), 1e-9 * H.norm());
  const Eigen::VectorXd e = residual_of(prior, {pose_, speed_bias_});
  EXPECT_LT((prior.jacobian().transpose() * e - g).norm(), 1e-9 * g.norm());
  expect_numeric_jacobians(prior, {pose_, speed_bias_});
}

TEST_F(PriorTest, KeepsItsJacobianWhereverTheStatesAre) {
  const Eigen::MatrixXd A = random_matrix(30, 15, 3);
  const MarginalizationPrior prior(states_, A.transpose() * A, Eigen::VectorXd::Zero(15));
  const auto moved_pose = moved(pose_, 0.3 * Vector6d::Ones());
  const auto J = jacobians_of(prior, {moved_pose, speed_bias_});
  EXPECT_EQ(J[0].leftCols<6>(), prior.jacobian().leftCols<6>());
  EXPECT_EQ(J[1], prior.jacobian().rightCols<9>());
}

TEST_F(PriorTest, SaysNothingAboutUnknownDirections) {
  const Eigen::MatrixXd N = gauge_directions(states_);
  NormalEquations system;
  const Eigen::MatrixXd A = random_matrix(30, 15, 3);
  system.H = A.transpose() * A;
  system.g = random_matrix(15, 1, 5);
  project_out(N, system);
  const MarginalizationPrior prior(states_, system.H, system.g);
  EXPECT_EQ(prior.num_residuals(), 11);
  EXPECT_LT((prior.jacobian() * N).norm(), 1e-12 * prior.jacobian().norm());
}

class WindowGraphTest : public testing::Test {
 protected:
  // Of the whole graph, keyframes from `first` on kept, with yaw and position of `held` fixed.
  NormalEquations system(const std::vector<VisualFactor>& visual,
                         std::size_t first,
                         const GraphKeyframe* held) {
    inertial_ = inertial_factors(graph_);
    std::vector<ResidualBlock> blocks;
    if (graph_.prior != nullptr) {
      blocks.push_back(block_of(*graph_.prior));
    }
    for (const GraphFactor& factor : inertial_) {
      blocks.push_back(block_of(factor));
    }
    std::vector<const double*> points;
    for (const VisualFactor& factor : visual) {
      blocks.push_back(block_of(factor.factor, &huber_));
      if (std::find(points.begin(), points.end(), factor.factor.parameters[1]) == points.end()) {
        points.push_back(factor.factor.parameters[1]);
      }
    }
    if (held != nullptr) {
      gauge_ = std::make_unique<GaugeFactor>(pose_from(held->pose.data()),
                                             held->first_pose ? &*held->first_pose : nullptr);
      blocks.push_back({gauge_.get(), nullptr, {held->pose.data()}});
    }
    std::vector<ParameterBlock> kept;
    for (std::size_t i = first; i < graph_.keyframes.size(); ++i) {
      kept.push_back({graph_.keyframes[i].pose.data(), 6});
      kept.push_back({graph_.keyframes[i].speed_bias.data(), 9});
    }
    return schur_complement(blocks, kept, points);
  }

  // Where the Jacobians of all factors on a state are taken.
  std::vector<PriorState> linearization_points() const {
    std::vector<PriorState> states;
    for (const GraphKeyframe& keyframe : graph_.keyframes) {
      const PoseParameters pose = keyframe.first_pose.value_or(keyframe.pose);
      const SpeedBiasParameters speed = keyframe.first_speed_bias.value_or(keyframe.speed_bias);
      states.push_back({keyframe.pose.data(), Eigen::Map<const Eigen::VectorXd>(pose.data(), 7)});
      states.push_back(
          {keyframe.speed_bias.data(), Eigen::Map<const Eigen::VectorXd>(speed.data(), 9)});
    }
    return states;
  }

  // Information along the gauge, relative to that along random directions of the same length.
  double gauge_information(const Eigen::MatrixXd& H) const {
    const Eigen::MatrixXd N = gauge_directions(linearization_points()).colwise().normalized();
    return (N.transpose() * H * N).diagonal().maxCoeff() / H.diagonal().mean();
  }

  SimulatedRun run_{noisy_run()};
  SlidingWindow::Config config_ = simulated_vio_config(0.5).window;
  WindowGraph graph_ = slid_graph(run_, config_);
  ceres::HuberLoss huber_{2.5};
  std::vector<GraphFactor> inertial_;
  std::unique_ptr<GaugeFactor> gauge_;
};

TEST_F(WindowGraphTest, PriorKnowsNothingOfYawAndPosition) {
  ASSERT_NE(graph_.prior, nullptr);
  const Eigen::MatrixXd N = gauge_directions(graph_.prior->states()).colwise().normalized();
  const Eigen::MatrixXd& J = graph_.prior->jacobian();
  EXPECT_GT(J.rows(), 20);
  EXPECT_LT((J * N).norm(), 1e-10 * J.norm());
}

TEST_F(WindowGraphTest, NoFactorKnowsAnythingOfYawAndPosition) {
  double moved = 0.0;
  for (const PriorState& state : graph_.prior->states()) {
    moved = std::max(moved, difference(state, state.values).norm());
  }
  EXPECT_GT(moved, 1e-4);  // otherwise this would test nothing
  const NormalEquations with = system(visual_factors(graph_, 0.5), 0, nullptr);
  EXPECT_LT(gauge_information(with.H), 1e-12);
}

TEST_F(WindowGraphTest, WithoutFirstEstimatesYawWouldBecomeKnown) {
  for (GraphKeyframe& keyframe : graph_.keyframes) {
    keyframe.first_pose.reset();
    keyframe.first_speed_bias.reset();
  }
  const NormalEquations without = system(visual_factors(graph_, 0.5), 0, nullptr);
  EXPECT_GT(gauge_information(without.H), 1e-10);
}

TEST_F(WindowGraphTest, MarginalizingEqualsTheDenseSolution) {
  // Landmarks that live on lose their observation in the oldest keyframe before both.
  std::vector<VisualFactor> visual = visual_factors(graph_, 0.5);
  std::erase_if(visual, [&](const VisualFactor& factor) {
    return factor.keyframe == 0 &&
           find_observation(graph_.keyframes.back().observations, factor.landmark) != nullptr;
  });
  for (GraphKeyframe& keyframe : graph_.keyframes) {  // off the optimum
    keyframe.pose =
        to_parameters(retract(pose_from(keyframe.pose.data()), 1e-3 * Vector6d::Ones()));
  }
  const GraphKeyframe& held = graph_.keyframes[1];
  const NormalEquations dense = system(visual, 0, &held);
  const Eigen::VectorXd expected = dense.H.ldlt().solve(-dense.g).tail(dense.g.size() - 15);

  marginalize_oldest(graph_, config_);
  const NormalEquations after = system(visual_factors(graph_, 0.5), 0, &held);
  const Eigen::VectorXd step = after.H.ldlt().solve(-after.g);
  ASSERT_EQ(step.size(), expected.size());
  EXPECT_GT(expected.norm(), 1e-3);
  EXPECT_LT((step - expected).norm(), 1e-6 * expected.norm());
}

}  // namespace
}  // namespace fleetloc
