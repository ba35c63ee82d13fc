#include "robot/uplink/keyframe_history.hpp"

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "test/unit/compact/moving_robot.hpp"

namespace fleetloc {
namespace {

KeyframeId id(std::uint32_t number) {
  return KeyframeId{number};
}

/// Windows of ten keyframes, one after the other, as the odometry gives them.
KeyframeHistory history_of(const Submap& drive, std::size_t max_keyframes) {
  KeyframeHistory history(max_keyframes);
  for (std::size_t end = 1; end <= drive.keyframes.size(); ++end) {
    Submap window;
    const std::size_t begin = end > 10 ? end - 10 : 0;
    for (std::size_t i = begin; i < end; ++i) window.keyframes.push_back(drive.keyframes[i]);
    for (std::size_t i = begin; i + 1 < end; ++i) window.edges.push_back(drive.edges[i]);
    history.add(window);
  }
  return history;
}

TEST(KeyframeHistory, KeepsTheLatestWithTheirEdges) {
  const Submap drive = moving_robot(100, 30);
  const KeyframeHistory history = history_of(drive, 20);
  ASSERT_EQ(history.keyframes().size(), 20U);
  EXPECT_EQ(history.keyframes().front().id, id(110));
  EXPECT_EQ(history.edge_into(id(110)), nullptr);
  EXPECT_NE(history.edge_into(id(111)), nullptr);
  EXPECT_EQ(history.newer_than(id(125)), 4U);
  EXPECT_EQ(history.find(id(109)), nullptr);
}

TEST(KeyframeHistory, ANewerWindowReplacesItems) {
  Submap drive = moving_robot(100, 5);
  KeyframeHistory history = history_of(drive, 20);
  drive.keyframes[2].observations.clear();
  drive.edges[1].T_from_to.p.x() = 42.0;
  history.add(drive);
  EXPECT_TRUE(history.find(id(102))->observations.empty());
  EXPECT_EQ(history.edge_into(id(102))->T_from_to.p.x(), 42.0);
}

// Monte Carlo: the scatter of the product of disturbed steps is what the composed edge states.
TEST(KeyframeHistory, ComposedEdgesHaveTheCovarianceOfTheirSteps) {
  const Submap drive = moving_robot(100, 9);
  const KeyframeHistory history = history_of(drive, 20);
  const auto edge = history.composed({.to = id(108), .from = id(100)});
  ASSERT_TRUE(edge);
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  Matrix6d scatter = Matrix6d::Zero();
  constexpr int kRuns = 4000;
  for (int run = 0; run < kRuns; ++run) {
    Pose T;
    for (const VirtualEdge& step : drive.edges) {
      const Eigen::LLT<Matrix6d> root(step.information.inverse());
      Vector6d noise;
      for (Eigen::Index i = 0; i < 6; ++i) noise[i] = normal(random);
      T = T * retract(step.T_from_to, root.matrixL() * noise);
    }
    const Vector6d error = local_coordinates(edge->T_from_to, T);
    scatter += error * error.transpose() / kRuns;
  }
  const Matrix6d stated = edge->information.inverse();
  for (Eigen::Index i = 0; i < 6; ++i) {
    EXPECT_NEAR(scatter(i, i) / stated(i, i), 1.0, 0.15) << i;
  }
}

TEST(KeyframeHistory, NothingIsComposedOverAMissingStep) {
  Submap drive = moving_robot(100, 9);
  drive.edges.erase(drive.edges.begin() + 4);
  KeyframeHistory history(20);
  history.add(drive);
  EXPECT_FALSE(history.composed({.to = id(108), .from = id(100)}));
  EXPECT_TRUE(history.composed({.to = id(108), .from = id(105)}));
  EXPECT_FALSE(history.composed({.to = id(108), .from = id(50)}));
}

TEST(KeyframeHistory, ASubmapHasReferencesForTheEndsOfItsEdges) {
  const KeyframeHistory history = history_of(moving_robot(100, 20), 40);
  const std::vector<KeyframeId> keyframes{id(118), id(119)};
  const std::vector<EdgeKey> edges{{id(119), id(118)}, {id(119), id(111)}};
  const Submap submap = history.submap(keyframes, edges);
  ASSERT_EQ(submap.keyframes.size(), 3U);
  EXPECT_EQ(submap.keyframes[0].id, id(111));
  EXPECT_TRUE(submap.keyframes[0].is_reference);
  EXPECT_FALSE(submap.keyframes[2].is_reference);
  EXPECT_EQ(submap.edges.size(), 2U);
}

}  // namespace
}  // namespace fleetloc
