#include "robot/vio/window_corrections.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "robot/submap/sparsification.hpp"
#include "test/unit/vio/simulated_correction.hpp"
#include "test/unit/vio/slid_graph.hpp"

namespace fleetloc {
namespace {

using ::testing::Test;

class WindowCorrectionsTest : public Test {
 protected:
  [[nodiscard]] KeyframeId id_of(std::size_t keyframe) const {
    return graph_.keyframes[keyframe].id;
  }

  const SimulatedRun run_{noisy_run()};
  const SlidingWindow::Config config_ = simulated_vio_config(0.5).window;
  WindowGraph graph_ = slid_graph(run_, config_);
  Correction correction_ = SimulatedCloud{}.correction(run_, graph_);
};

TEST_F(WindowCorrectionsTest, AreTakenOverAsFarAsTheirStatesAreInTheWindow) {
  const int known = size_of(correction_);
  ASSERT_GT(correction_.landmarks.size(), 20U);
  ASSERT_EQ(correction_.relative_poses.size(), graph_.keyframes.size() - 1);
  correction_.landmarks.push_back(
      {LandmarkId{1000000}, Eigen::Vector3d::Zero(), Eigen::Matrix3d::Identity()});
  correction_.relative_poses.insert(correction_.relative_poses.begin(),
                                    {KeyframeId{1}, id_of(0), {}, Matrix6d::Identity()});
  const MergeCount count = merge(correction_, graph_);
  EXPECT_EQ(count.applied, known);
  EXPECT_EQ(count.ignored, 2);
  EXPECT_EQ(correction_factors(graph_).size(), static_cast<std::size_t>(known));
}

TEST_F(WindowCorrectionsTest, AreOneForEachLandmarkAndPairAndTheNewestWins) {
  merge(correction_, graph_);
  const std::size_t factors = correction_factors(graph_).size();
  Correction second = correction_;
  for (Correction::Landmark& landmark : second.landmarks) landmark.p_anchor.x() += 1.0;
  for (Correction::RelativePose& relative : second.relative_poses) relative.T_from_to.p.x() += 1.0;
  EXPECT_EQ(merge(second, graph_).applied, size_of(second));
  EXPECT_EQ(correction_factors(graph_).size(), factors);
  const Correction::Landmark& landmark = second.landmarks.front();
  EXPECT_EQ(graph_.corrections.landmarks.at(landmark.id).correction.p_anchor, landmark.p_anchor);
  const Correction::RelativePose& pair = second.relative_poses.front();
  EXPECT_EQ(graph_.corrections.relative_poses.at({pair.from, pair.to}).T_from_to.p,
            pair.T_from_to.p);
}

TEST_F(WindowCorrectionsTest, OfPairsThatANewerOnePartsOrSpansAreReplaced) {
  merge(correction_, graph_);
  const std::size_t pairs = graph_.corrections.relative_poses.size();
  const Correction::RelativePose spanning{id_of(1), id_of(3), {}, Matrix6d::Identity()};
  Correction second = correction_;
  second.relative_poses = {spanning};
  merge(second, graph_);
  EXPECT_EQ(graph_.corrections.relative_poses.size(), pairs - 1);
  EXPECT_TRUE(graph_.corrections.relative_poses.contains({id_of(1), id_of(3)}));
  merge(correction_, graph_);
  EXPECT_EQ(graph_.corrections.relative_poses.size(), pairs);
  EXPECT_FALSE(graph_.corrections.relative_poses.contains({id_of(1), id_of(3)}));
}

TEST_F(WindowCorrectionsTest, AreForgottenAndThoseOfOvertakenAnswersStayOutdated) {
  merge(correction_, graph_);
  forget_corrections(graph_);
  EXPECT_TRUE(correction_factors(graph_).empty());
  Correction late = correction_;
  late.anchor = id_of(1);
  EXPECT_EQ(merge(late, graph_).applied, 0);
  EXPECT_GT(merge(correction_, graph_).applied, 0);
}

TEST_F(WindowCorrectionsTest, OfAnAnswerThatWasOvertakenAreIgnored) {
  merge(correction_, graph_);
  Correction late = correction_;
  late.anchor = id_of(1);
  for (Correction::Landmark& landmark : late.landmarks) landmark.p_anchor.x() += 1.0;
  const MergeCount count = merge(late, graph_);
  EXPECT_EQ(count.applied, 0);
  EXPECT_EQ(count.ignored, size_of(late));
  const Correction::Landmark& first = correction_.landmarks.front();
  EXPECT_EQ(graph_.corrections.landmarks.at(first.id).correction.p_anchor, first.p_anchor);
}

TEST_F(WindowCorrectionsTest, OfLandmarksAreIgnoredWithoutTheirAnchor) {
  correction_.anchor = KeyframeId{static_cast<std::uint32_t>(correction_.anchor) + 1};
  const MergeCount count = merge(correction_, graph_);
  EXPECT_EQ(count.applied, static_cast<int>(correction_.relative_poses.size()));
  EXPECT_EQ(count.ignored, static_cast<int>(correction_.landmarks.size()));
}

TEST_F(WindowCorrectionsTest, LeaveWithTheirStates) {
  merge(correction_, graph_);
  const std::size_t before = graph_.corrections.landmarks.size();
  marginalize_oldest(graph_, config_);
  EXPECT_EQ(graph_.corrections.relative_poses.size(), graph_.keyframes.size() - 1);
  EXPECT_LT(graph_.corrections.landmarks.size(), before);
  EXPECT_GT(graph_.corrections.landmarks.size(), 0U);
  for (const auto& [id, landmark] : graph_.corrections.landmarks) {
    EXPECT_TRUE(graph_.landmarks.at(id).is_active());
  }
  while (graph_.keyframes.size() > 1) {
    EXPECT_FALSE(graph_.corrections.landmarks.empty());
    marginalize_oldest(graph_, config_);
  }
  EXPECT_TRUE(graph_.corrections.relative_poses.empty());
}

TEST_F(WindowCorrectionsTest, OfLandmarksLeaveWithTheirAnchor) {
  correction_.anchor = id_of(0);
  merge(correction_, graph_);
  EXPECT_FALSE(graph_.corrections.landmarks.empty());
  marginalize_oldest(graph_, config_);
  EXPECT_TRUE(graph_.corrections.landmarks.empty());
}

TEST_F(WindowCorrectionsTest, MoveTheWindow) {
  WindowGraph without = slid_graph(run_, config_);
  merge(correction_, graph_);
  optimize(graph_, config_);
  optimize(without, config_);
  double moved = 0.0;
  for (std::size_t i = 0; i < graph_.keyframes.size(); ++i) {
    moved = std::max(
        moved,
        (state_of(graph_.keyframes[i]).T_odom_body.p - state_of(without.keyframes[i]).T_odom_body.p)
            .norm());
  }
  EXPECT_GT(moved, 1e-3);
}

// A graph with corrections that has been optimized, and one without them at the same states.
class OneLinearizationPoint : public WindowCorrectionsTest {
 protected:
  OneLinearizationPoint() {
    merge(correction_, graph_);
    optimize(graph_, config_);
    for (std::size_t i = 0; i < graph_.keyframes.size(); ++i) {
      const GraphKeyframe& from = graph_.keyframes[i];
      GraphKeyframe& to = without_.keyframes[i];
      to.pose = from.pose;
      to.speed_bias = from.speed_bias;
      to.from_previous = from.from_previous;
    }
    for (auto& [id, landmark] : without_.landmarks) {
      landmark.p_odom = graph_.landmarks.at(id).p_odom;
    }
  }

  static Eigen::VectorXd residual(const MarginalizationPrior& prior) {
    Eigen::VectorXd r(prior.num_residuals());
    const ResidualBlock block = block_of(prior);
    prior.Evaluate(block.parameters.data(), r.data(), nullptr);
    return r;
  }

  ChainOfPoses edges(WindowGraph& graph) const {
    const OdometryMarginal marginal = odometry_marginal(graph, config_);
    InertialWindow window;
    for (const GraphKeyframe& keyframe : graph.keyframes) {
      window.states.push_back(state_of(keyframe));
      if (keyframe.from_previous) window.between.push_back(*keyframe.from_previous);
    }
    window.oldest_covariance = marginal.covariance.block<9, 9>(6, 6);
    return virtual_odometry(window, InertialModel::kInertialMean).value();
  }

  WindowGraph without_ = slid_graph(run_, config_);
};

TEST_F(OneLinearizationPoint, CovarianceIsTheSameBitForBit) {
  ASSERT_FALSE(graph_.corrections.landmarks.empty());
  const OdometryMarginal with = odometry_marginal(graph_, config_);
  const OdometryMarginal without = odometry_marginal(without_, config_);
  EXPECT_EQ(with.covariance, without.covariance);
  EXPECT_EQ(with.mean, without.mean);
  EXPECT_GT(with.mean.norm(), 1e-4);  // the corrections have moved the states from there
}

TEST_F(OneLinearizationPoint, EdgesOfTheSubmapAreTheSameBitForBit) {
  const ChainOfPoses with = edges(graph_);
  const ChainOfPoses without = edges(without_);
  ASSERT_EQ(with.edges.size(), without.edges.size());
  for (std::size_t i = 0; i < with.edges.size(); ++i) {
    EXPECT_EQ(with.edges[i].T_from_to.p, without.edges[i].T_from_to.p);
    EXPECT_EQ(with.edges[i].information, without.edges[i].information);
  }
}

TEST_F(OneLinearizationPoint, PriorIsTheSameBitForBit) {
  while (graph_.keyframes.size() > 2) {
    marginalize_oldest(graph_, config_);
    marginalize_oldest(without_, config_);
    EXPECT_EQ(graph_.prior->jacobian(), without_.prior->jacobian());
    EXPECT_EQ(residual(*graph_.prior), residual(*without_.prior));
  }
}

TEST(CorrectedGraph, KnowsNothingOfYawAndPosition) {
  const SimulatedRun run(noisy_run());
  const SlidingWindow::Config config = simulated_vio_config(0.5).window;
  SimulatedCloud cloud;
  cloud.noise = true;
  WindowGraph graph =
      slid_graph(run, config, [&](WindowGraph& now) { merge(cloud.correction(run, now), now); });
  std::vector<ResidualBlock> blocks{block_of(*graph.prior)};
  const std::vector<GraphFactor> inertial = inertial_factors(graph);
  const std::vector<VisualFactor> visual = visual_factors(graph, 0.5);
  const std::vector<GraphFactor> corrections = correction_factors(graph);
  ASSERT_GT(corrections.size(), 20U);
  for (const GraphFactor& factor : inertial) blocks.push_back(block_of(factor));
  for (const VisualFactor& factor : visual) blocks.push_back(block_of(factor.factor));
  for (const GraphFactor& factor : corrections) blocks.push_back(block_of(factor));
  std::vector<const double*> points;
  for (const auto& [id, landmark] : graph.landmarks) {
    if (landmark.is_active()) points.push_back(landmark.p_odom.data());
  }
  std::vector<ParameterBlock> kept;
  std::vector<PriorState> states;
  double moved = 0.0;
  for (const GraphKeyframe& keyframe : graph.keyframes) {
    const PoseParameters pose = keyframe.first_pose.value_or(keyframe.pose);
    const SpeedBiasParameters speed = keyframe.first_speed_bias.value_or(keyframe.speed_bias);
    kept.push_back({keyframe.pose.data(), 6});
    kept.push_back({keyframe.speed_bias.data(), 9});
    states.push_back({keyframe.pose.data(), Eigen::Map<const Eigen::VectorXd>(pose.data(), 7)});
    states.push_back(
        {keyframe.speed_bias.data(), Eigen::Map<const Eigen::VectorXd>(speed.data(), 9)});
    moved = std::max(moved, difference(states[states.size() - 2], keyframe.pose.data()).norm());
  }
  EXPECT_GT(moved, 1e-4);  // otherwise this would test nothing
  const Eigen::MatrixXd H = schur_complement(blocks, kept, points).H;
  const Eigen::MatrixXd N = gauge_directions(states).colwise().normalized();
  EXPECT_LT((N.transpose() * H * N).diagonal().maxCoeff(), 1e-12 * H.diagonal().mean());
  const Eigen::MatrixXd N_prior = gauge_directions(graph.prior->states()).colwise().normalized();
  const Eigen::MatrixXd& J = graph.prior->jacobian();
  EXPECT_LT((J * N_prior).norm(), 1e-10 * J.norm());
}

}  // namespace
}  // namespace fleetloc
