#include <gtest/gtest.h>

#include "deploy/config/default_config.hpp"
#include "robot/submap/submap_builder.hpp"
#include "test/unit/submap/default_builder.hpp"
#include "test/unit/submap/simulated_window.hpp"
#include "test/unit/vio/simulated_vio.hpp"

// Edges of a chain count as independent on the cloud, and are not: the oldest velocity and biases
// of one window are nearly those of the next. What their inflation is worth is judged at the end
// of a chain of the cloud's length.
namespace fleetloc {
namespace {

constexpr std::size_t kChain = 40;  // keyframes
struct Chain {
  std::vector<VirtualEdge> edges;  // as they were when they left the window, oldest first
  Pose T_first_last_truth;
};

/// Normalized squared error of the last pose of the chain, per degree of freedom.
double end_point_nees(const Chain& chain, double inflation) {
  Pose T_first_last;
  Matrix6d covariance = Matrix6d::Zero();
  for (const VirtualEdge& edge : chain.edges) {
    const Matrix6d moved = adjoint(inverse(edge.T_from_to));
    covariance = moved * covariance * moved.transpose() + inflation * edge.information.inverse();
    T_first_last = T_first_last * edge.T_from_to;
  }
  const Vector6d error = local_coordinates(chain.T_first_last_truth, T_first_last);
  return error.dot(covariance.ldlt().solve(error)) / 6.0;
}

double mean_nees(const std::vector<Chain>& chains, double inflation) {
  double sum = 0.0;
  for (const Chain& chain : chains) sum += end_point_nees(chain, inflation);
  return sum / static_cast<double>(chains.size());
}

SubmapBuilder builder_without_inflation(InertialModel model = InertialModel::kInertialMean) {
  SubmapBuilder::Config config = default_builder_config();
  config.edge_covariance_inflation = 1.0;
  config.model = model;
  return SubmapBuilder(config);
}

/// Windows whose oldest velocity and biases are wrong, each in its own way.
Chain chain_of_independent_windows(std::uint64_t seed) {
  const SimulatedRun run = simulated_run(seed, true);
  const SimulatedKeyframes keyframes(run, {}, kChain + kWindow, seed);
  SubmapBuilder builder = builder_without_inflation();
  Chain chain;
  for (std::size_t first = 0; first + 1 < kChain; ++first) {
    SubmapInput input{
        .inertial = keyframes.window(first, kWindow), .keyframes = {}, .landmarks = {}};
    for (std::size_t i = first; i < first + kWindow; ++i) {
      input.keyframes.push_back({.id = KeyframeId{static_cast<std::uint32_t>(i)},
                                 .stamp = keyframe_stamp(static_cast<int>(i)),
                                 .tilt_sigma = 0.01,
                                 .observations = {}});
    }
    chain.edges.push_back(builder.build(input).edges.front());
  }
  chain.T_first_last_truth =
      inverse(keyframes.truth().front().T_odom_body) * keyframes.truth()[kChain - 1].T_odom_body;
  return chain;
}

/// The odometry's own windows, four keyframes a second; its noise is that of the simulation.
Chain chain_of_odometry(std::uint64_t seed, InertialModel model) {
  constexpr int kFrames = 5;  // between keyframes
  constexpr int kStart = 5;   // keyframes that start the window
  constexpr int kFirst = 10;  // keyframe of the chain: the window has filled
  SimulatedRun::Config simulation;
  simulation.seed = seed;
  simulation.imu_white_noise = true;
  simulation.imu_bias_walk = true;
  simulation.pixel_sigma = 0.5;
  simulation.initial_bias = {{0.002, -0.01, 0.005}, {0.05, -0.03, 0.1}};
  const SimulatedRun run(simulation);
  SlidingWindow window(run.stereo(),
                       run.noise(),
                       simulated_vio_config(simulation.pixel_sigma).window,
                       true_initialization(run, 0, kStart, kFrames));
  SubmapBuilder builder = builder_without_inflation(model);
  Chain chain;
  for (int k = kStart; chain.edges.size() + 1 < kChain; ++k) {
    const WindowEstimate estimate = window.add(
        keyframe_input(run, k * kFrames, (k - 1) * kFrames, static_cast<std::uint32_t>(k)));
    SubmapInput input{.inertial = estimate.inertial, .keyframes = {}, .landmarks = {}};
    for (const WindowKeyframe& keyframe : estimate.keyframes) {
      input.keyframes.push_back({keyframe.id, keyframe.stamp, keyframe.tilt_sigma, {}});
    }
    const Submap submap = builder.build(input);
    if (submap.edges.front().from >= KeyframeId{kFirst}) {
      chain.edges.push_back(submap.edges.front());
    }
  }
  const auto truth = [&](std::size_t keyframe) {
    return run.truth(run.frame_stamp(static_cast<int>(keyframe) * kFrames)).T_odom_body;
  };
  chain.T_first_last_truth = inverse(truth(kFirst)) * truth(kFirst + kChain - 1);
  return chain;
}

TEST(ChainConsistency, EdgesOfIndependentWindowsNeedNoInflation) {
  std::vector<Chain> chains;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    chains.push_back(chain_of_independent_windows(seed));
  }
  const double nees = mean_nees(chains, 1.0);
  RecordProperty("nees", std::to_string(nees));
  EXPECT_GT(nees, 0.5);
  EXPECT_LT(nees, 1.5);
}

TEST(ChainConsistency, InflationMakesTheEndOfTheOdometrysChainHonest) {
  std::vector<Chain> chains;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    chains.push_back(chain_of_odometry(seed, InertialModel::kInertialMean));
  }
  const double before = mean_nees(chains, 1.0);
  const double after = mean_nees(chains, default_builder_config().edge_covariance_inflation);
  RecordProperty("nees_without_inflation", std::to_string(before));
  RecordProperty("nees_with_inflation", std::to_string(after));
  EXPECT_GT(before, 2.0);
  EXPECT_GT(after, 0.4);
  EXPECT_LT(after, 2.0);
}

TEST(ChainConsistency, ThePapersEdgesAreMoreOverconfident) {
  const double papers = end_point_nees(chain_of_odometry(1, InertialModel::kPaper), 1.0);
  const double ours = end_point_nees(chain_of_odometry(1, InertialModel::kInertialMean), 1.0);
  RecordProperty("nees_paper", std::to_string(papers));
  EXPECT_GT(papers, 2.0 * ours);
}

}  // namespace
}  // namespace fleetloc
