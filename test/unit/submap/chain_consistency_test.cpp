#include <gtest/gtest.h>

#include "robot/submap/submap_builder.hpp"
#include "shared/config/default_config.hpp"
#include "test/unit/submap/simulated_window.hpp"

// Edges of a chain count as independent on the cloud, and are not: the oldest velocity and biases
// of one window are nearly those of the next. What their inflation is worth is judged at the end
// of a chain of the cloud's length.
namespace fleetloc {
namespace {

constexpr int kChain = 40;  // keyframes
constexpr int kWindow = 10;
constexpr int kRuns = 16;

SubmapBuilder::Config config_with(double inflation) {
  SubmapBuilder::Config config = read_submap_builder_config(
      ConfigReader::from_string(default_config("robot")).section("submap"));
  if (inflation > 0.0) config.edge_covariance_inflation = inflation;
  return config;
}

/// The edges as they were when they left the window, oldest first.
std::vector<VirtualEdge> final_edges(const SimulatedKeyframes& keyframes,
                                     const SubmapBuilder::Config& config) {
  SubmapBuilder builder(config);
  std::vector<VirtualEdge> edges;
  for (std::size_t first = 0; first + 1 < kChain; ++first) {
    SubmapInput input{
        .inertial = keyframes.window(first, kWindow), .keyframes = {}, .landmarks = {}};
    for (std::size_t i = 0; i < kWindow; ++i) {
      const auto index = static_cast<int>(first + i);
      input.keyframes.push_back({.id = KeyframeId{static_cast<std::uint32_t>(index)},
                                 .stamp = keyframe_stamp(index),
                                 .tilt_sigma = 0.01,
                                 .observations = {}});
    }
    edges.push_back(builder.build(input).edges.front());
  }
  return edges;
}

/// Normalized squared error of the last pose of the chain, per degree of freedom.
double end_point_nees(const SimulatedKeyframes& keyframes, const std::vector<VirtualEdge>& edges) {
  Pose T_first_last;
  Matrix6d covariance = Matrix6d::Zero();
  for (const VirtualEdge& edge : edges) {
    const Matrix6d moved = adjoint(inverse(edge.T_from_to));
    covariance = moved * covariance * moved.transpose() + edge.information.inverse();
    T_first_last = T_first_last * edge.T_from_to;
  }
  const std::vector<NavState>& truth = keyframes.truth();
  const Vector6d error = local_coordinates(
      inverse(truth[0].T_odom_body) * truth[kChain - 1].T_odom_body, T_first_last);
  return error.dot(covariance.ldlt().solve(error)) / 6.0;
}

double mean_nees(const SimulatedOdometry& odometry, double inflation) {
  double sum = 0.0;
  for (int i = 0; i < kRuns; ++i) {
    const auto seed = static_cast<std::uint64_t>(100 + i);
    const SimulatedRun run = simulated_run(seed, true);
    const SimulatedKeyframes keyframes(run, odometry, kChain + kWindow, seed);
    sum += end_point_nees(keyframes, final_edges(keyframes, config_with(inflation)));
  }
  return sum / kRuns;
}

// The bias errors of a sliding window outlive it, those of velocity do not.
const SimulatedOdometry kOdometry{.velocity_correlation_s = 2.5, .bias_correlation_s = 10.0};

TEST(ChainConsistency, IndependentErrorsNeedNoInflation) {
  const double nees = mean_nees({}, 1.0);
  RecordProperty("nees", std::to_string(nees));
  EXPECT_GT(nees, 0.5);
  EXPECT_LT(nees, 2.0);
}

TEST(ChainConsistency, InflationMakesTheEndPointOfTheCloudsWindowHonest) {
  const double before = mean_nees(kOdometry, 1.0);
  const double after = mean_nees(kOdometry, 0.0);
  RecordProperty("nees_without_inflation", std::to_string(before));
  RecordProperty("nees_with_inflation", std::to_string(after));
  EXPECT_GT(before, 1.5);
  EXPECT_GT(after, 0.5);
  EXPECT_LT(after, 1.5);
}

}  // namespace
}  // namespace fleetloc
