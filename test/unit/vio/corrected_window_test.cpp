// The sliding window with what a cloud would send back, made from the simulation's truth.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "robot/submap/sparsification.hpp"
#include "test/unit/vio/simulated_correction.hpp"
#include "test/unit/vio/slid_graph.hpp"

namespace fleetloc {
namespace {

constexpr int kAdded = 20;  // keyframes after the first ones

// All windows of a run; each correction comes one keyframe late.
std::vector<WindowEstimate> windows_of(const SimulatedRun& run,
                                       const SlidingWindow::Config& config,
                                       const std::optional<SimulatedCloud>& cloud) {
  SlidingWindow window(run.stereo(), run.noise(), config, true_initialization(run, 40, 4, 6));
  std::vector<WindowEstimate> windows{window.estimate()};
  for (int i = 4; i < 4 + kAdded; ++i) {
    const int frame = 40 + 6 * i;
    KeyframeInput input = keyframe_input(run, frame, frame - 6, static_cast<std::uint32_t>(i));
    if (cloud) input.correction = cloud->correction(run, windows.back());
    windows.push_back(window.add(input));
  }
  return windows;
}

// Of the newest keyframe relative to the oldest: what a window says by itself [m], root mean
// square over all windows.
double relative_error(const SimulatedRun& run, const std::vector<WindowEstimate>& windows) {
  double sum = 0.0;
  for (const WindowEstimate& window : windows) {
    const WindowKeyframe& oldest = window.keyframes.front();
    const WindowKeyframe& newest = window.keyframes.back();
    const Pose estimate = inverse(oldest.state.T_odom_body) * newest.state.T_odom_body;
    const Pose truth =
        inverse(run.truth(oldest.stamp).T_odom_body) * run.truth(newest.stamp).T_odom_body;
    sum += (estimate.p - truth.p).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(windows.size()));
}

class CorrectedWindow : public testing::Test {
 protected:
  static SimulatedRun::Config noise(std::uint64_t seed) {
    SimulatedRun::Config config = noisy_run();
    config.imu_bias_walk = true;
    config.seed = seed;
    return config;
  }
  double mean_error(const std::optional<SimulatedCloud>& cloud) const {
    double sum = 0.0;
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
      const SimulatedRun run(noise(seed));
      sum += relative_error(run, windows_of(run, config_, cloud)) / 3.0;
    }
    return sum;
  }

  SimulatedRun run_{noise(1)};
  SlidingWindow::Config config_ = simulated_vio_config(0.5).window;
};

TEST_F(CorrectedWindow, MovesTowardsTheTruth) {
  SimulatedCloud noisy;
  noisy.noise = true;
  const double without = mean_error(std::nullopt);
  const double with_truth = mean_error(SimulatedCloud{});
  const double with_noise = mean_error(noisy);
  std::printf("newest keyframe in the oldest: %.4f m, with true corrections %.4f m, noisy %.4f m\n",
              without,
              with_truth,
              with_noise);
  EXPECT_LT(with_truth, 0.7 * without);
  EXPECT_LT(with_noise, without);
}

TEST_F(CorrectedWindow, IsAsWithoutThemIfTheyHaveNoInformation) {
  const auto without = windows_of(run_, config_, std::nullopt);
  SimulatedCloud ignorant;
  ignorant.landmark_sigma_m = INFINITY;
  ignorant.rotation_sigma_rad = INFINITY;
  ignorant.translation_sigma_m = INFINITY;
  const auto with = windows_of(run_, config_, ignorant);
  EXPECT_GT(with.back().diagnostics.corrections_applied, 20);
  for (std::size_t i = 0; i < with.size(); ++i) {
    const Vector6d moved = local_coordinates(with[i].keyframes.back().state.T_odom_body,
                                             without[i].keyframes.back().state.T_odom_body);
    EXPECT_LT(moved.norm(), 1e-9);
  }
}

TEST_F(CorrectedWindow, IgnoresAndCountsThemAllIfMergingIsOff) {
  const auto without = windows_of(run_, config_, std::nullopt);
  config_.merge = false;
  const auto off = windows_of(run_, config_, SimulatedCloud{});
  for (std::size_t i = 0; i < off.size(); ++i) {
    EXPECT_EQ(off[i].keyframes.back().state.T_odom_body.p,
              without[i].keyframes.back().state.T_odom_body.p);
    EXPECT_EQ(off[i].diagnostics.corrections_applied, 0);
  }
  EXPECT_GT(off.back().diagnostics.corrections_ignored, 20);
  EXPECT_EQ(without.back().diagnostics.corrections_ignored, 0);
}

TEST_F(CorrectedWindow, BearsLandmarksThatWereFoundInTheWrongPlace) {
  SimulatedCloud wrong;
  wrong.noise = true;
  wrong.outlier_share = 0.15;
  const double without = mean_error(std::nullopt);
  const double with = mean_error(wrong);
  std::printf(
      "newest keyframe in the oldest: %.4f m, 15 %% wrong landmarks %.4f m\n", without, with);
  EXPECT_LT(with, 1.1 * without);
}

// A map that is too large by 3 %, by many sigmas of the odometry: the cloud knows it already, and
// must not be told.
TEST_F(CorrectedWindow, KeepsWhatItIsToldOutOfItsSubmap) {
  SimulatedCloud large;
  large.scale = 1.03;
  const auto without = windows_of(run_, config_, std::nullopt);
  const auto with = windows_of(run_, config_, large);
  double states = 0.0;
  double edges = 0.0;
  double both = 0.0;
  for (std::size_t i = 10; i < with.size(); ++i) {
    const auto chain_with =
        virtual_odometry(with[i].inertial, InertialModel::kInertialMean).value();
    const auto chain_without =
        virtual_odometry(without[i].inertial, InertialModel::kInertialMean).value();
    for (std::size_t k = 0; k < chain_with.edges.size(); ++k) {
      const auto relative = [k](const InertialWindow& window) {
        return (inverse(window.states[k].T_odom_body) * window.states[k + 1].T_odom_body).p;
      };
      const Eigen::Vector3d p = relative(without[i].inertial);
      states += p.dot(relative(with[i].inertial) - p);
      edges += p.dot(chain_with.edges[k].T_from_to.p - chain_without.edges[k].T_from_to.p);
      both += p.squaredNorm();
    }
  }
  std::printf("longer: states %.4f, edges of the submap %.4f\n", states / both, edges / both);
  EXPECT_GT(states / both, 0.01);
  EXPECT_LT(std::abs(edges), 0.1 * states);
}

}  // namespace
}  // namespace fleetloc
