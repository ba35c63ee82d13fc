#include "robot/vio/sliding_window.hpp"

#include <algorithm>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "robot/vio/gauge_factor.hpp"
#include "shared/geometry/so3.hpp"
#include "test/unit/vio/simulated_vio.hpp"

namespace fleetloc {
namespace {

constexpr double kSeconds = 6.0;

double largest(const std::vector<CheckedState>& states, double (CheckedState::*error)() const) {
  double result = 0.0;
  for (const CheckedState& state : states) {
    result = std::max(result, (state.*error)());
  }
  return result;
}

double mean_nees(const std::vector<CheckedState>& states, int begin, int size) {
  double sum = 0.0;
  for (const CheckedState& state : states) {
    sum += state.nees(begin, size) / size;
  }
  return sum / static_cast<double>(states.size());
}

TEST(SlidingWindow, FollowsPerfectMeasurementsWithoutError) {
  const SimulatedRun run(SimulatedRun::Config{});
  const PlayedRun played = play(run, simulated_vio_config(0.5), kSeconds);
  ASSERT_TRUE(played.initialization.has_value());
  ASSERT_GT(played.keyframes.size(), 10U);
  RecordProperty("position_mm", std::to_string(1e3 * played.keyframes.back().position_error()));
  EXPECT_LT(largest(played.keyframes, &CheckedState::position_error), 2e-3);
  EXPECT_LT(largest(played.keyframes, &CheckedState::rotation_error), 1e-3);
}

struct Noise {
  const char* name;
  bool white;
  bool walk;
  double pixel_sigma;
  double outliers;
  double max_position_error;  // [m]
  double min_nees = 0.0;      // of the pose: that of the noise as it is assumed
};

class NoisySlidingWindow : public testing::TestWithParam<Noise> {};

// Averages over seeds: the error stays small and its covariance says how large it is. Noise that
// is assumed but absent makes the NEES small; then only the upper bound must hold.
TEST_P(NoisySlidingWindow, StaysConsistent) {
  double nees_pose = 0.0;
  double nees_all = 0.0;
  double nees_frames = 0.0;
  constexpr int kSeeds = 2;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    SimulatedRun::Config config;
    config.seed = seed;
    config.imu_white_noise = GetParam().white;
    config.imu_bias_walk = GetParam().walk;
    config.pixel_sigma = GetParam().pixel_sigma;
    config.outlier_share = GetParam().outliers;
    config.initial_bias = {{-0.002, 0.021, 0.08}, {-0.02, 0.07, 0.05}};
    const SimulatedRun run(config);
    const PlayedRun played = play(run, simulated_vio_config(0.5), kSeconds);
    ASSERT_TRUE(played.initialization.has_value()) << "seed " << seed;
    EXPECT_LT(largest(played.keyframes, &CheckedState::position_error),
              GetParam().max_position_error);
    nees_pose += mean_nees(played.keyframes, 0, 6) / kSeeds;
    nees_all += mean_nees(played.keyframes, 0, 15) / kSeeds;
    nees_frames += mean_nees(played.frames, 0, 6) / kSeeds;
  }
  std::printf("NEES per degree of freedom: pose %.2f, state %.2f, pose at frames %.2f\n",
              nees_pose,
              nees_all,
              nees_frames);
  EXPECT_LT(nees_pose, 2.0);
  EXPECT_GT(nees_pose, GetParam().min_nees);
  EXPECT_LT(nees_all, 2.0);
  EXPECT_LT(nees_frames, 2.5);
}

INSTANTIATE_TEST_SUITE_P(OneByOne,
                         NoisySlidingWindow,
                         testing::Values(Noise{"ImuWhite", true, false, 0.0, 0.0, 0.02},
                                         Noise{"ImuWalk", false, true, 0.0, 0.0, 0.02},
                                         Noise{"Pixels", false, false, 0.5, 0.0, 0.15},
                                         Noise{"Outliers", false, false, 0.0, 0.05, 0.05},
                                         Noise{"All", true, true, 0.5, 0.03, 0.15, 0.9}),
                         [](const auto& test) { return std::string(test.param.name); });

class FilledWindow : public testing::Test {
 protected:
  FilledWindow() : run_(noisy()), window_(run_.stereo(), run_.noise(), config_, start_) {}

  static SimulatedRun::Config noisy() {
    SimulatedRun::Config config;
    config.imu_white_noise = true;
    config.pixel_sigma = 0.5;
    return config;
  }
  WindowEstimate add_next() {
    const int frame = 40 + 6 * next_;
    return window_.add(keyframe_input(run_, frame, frame - 6, static_cast<std::uint32_t>(next_++)));
  }

  SimulatedRun run_;
  SlidingWindow::Config config_ = simulated_vio_config(0.5).window;
  Initialization start_ = true_initialization(run_, 40, 4, 6);
  int next_ = 4;
  SlidingWindow window_;
};

// What lies between others is known a little better than the oldest and the newest.
TEST_F(FilledWindow, TiltOfEachKeyframeIsAsCertainAsItSays) {
  constexpr int kSeeds = 12;
  std::vector<double> nees(10, 0.0);
  std::vector<double> sigma(10, 0.0);  // [rad]
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    SimulatedRun::Config config = noisy();
    config.seed = seed;
    const SimulatedRun run(config);
    SlidingWindow window(run.stereo(), run.noise(), config_, true_initialization(run, 40, 4, 6));
    WindowEstimate estimate;
    for (int i = 4; i < 16; ++i) {
      const int frame = 40 + 6 * i;
      estimate = window.add(keyframe_input(run, frame, frame - 6, static_cast<std::uint32_t>(i)));
    }
    for (std::size_t i = 0; i < nees.size(); ++i) {
      const WindowKeyframe& keyframe = estimate.keyframes.at(i);
      const Eigen::Quaterniond truth = run.truth(keyframe.stamp).T_odom_body.R;
      const Eigen::Vector3d error = log_so3(keyframe.state.T_odom_body.R * truth.conjugate());
      nees[i] += error.head<2>().squaredNorm() / (2.0 * std::pow(keyframe.tilt_sigma, 2)) / kSeeds;
      sigma[i] += keyframe.tilt_sigma / kSeeds;
    }
  }
  for (const double one : nees) {
    EXPECT_GT(one, 0.2);
    EXPECT_LT(one, 1.5);
  }
  EXPECT_LT(sigma[4], 0.995 * sigma.front());
  EXPECT_LT(sigma[4], 0.995 * sigma.back());
}

TEST_F(FilledWindow, GrowsToItsSizeAndSlides) {
  EXPECT_EQ(window_.estimate().keyframes.size(), 4U);
  for (int i = 0; i < 12; ++i) {
    const WindowEstimate estimate = add_next();
    EXPECT_EQ(estimate.keyframes.size(), static_cast<std::size_t>(std::min(10, 5 + i)));
    EXPECT_EQ(estimate.inertial.states.size(), estimate.keyframes.size());
    EXPECT_EQ(estimate.inertial.between.size(), estimate.keyframes.size() - 1);
    EXPECT_EQ(estimate.keyframes.back().id, KeyframeId{static_cast<std::uint32_t>(4 + i)});
    EXPECT_TRUE(estimate.diagnostics.converged);
  }
}

TEST_F(FilledWindow, CovarianceIsSymmetricPositiveAndDriftOnlyGrows) {
  double last_position = 0.0;
  for (int i = 0; i < 14; ++i) {
    const WindowEstimate estimate = add_next();
    const Matrix15d& P = estimate.covariance;
    EXPECT_LT((P - P.transpose()).norm(), 1e-12 * P.norm());
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix15d>(P).eigenvalues()(0), 0.0);
    const double position = P.block<3, 3>(3, 3).trace();
    if (i > 8) {
      EXPECT_GT(position, 0.8 * last_position);
    }
    last_position = position;
  }
}

// The gauge factor's sigma is not in it: twenty of them would be 4.5 mrad and 4.5 mm.
TEST_F(FilledWindow, DriftIsThatOfTheMeasurements) {
  WindowEstimate estimate;
  for (int i = 0; i < 26; ++i) estimate = add_next();  // twenty slide the window
  const Eigen::Matrix3d R = estimate.keyframes.back().state.T_odom_body.R.toRotationMatrix();
  const Eigen::Matrix3d rotation = R * estimate.covariance.topLeftCorner<3, 3>() * R.transpose();
  const double yaw_sigma = std::sqrt(rotation(2, 2));
  std::printf("yaw %.2f mrad, position %.1f mm\n",
              1e3 * yaw_sigma,
              1e3 * std::sqrt(estimate.covariance.block<3, 3>(3, 3).trace()));
  EXPECT_LT(yaw_sigma, 0.5 * std::sqrt(20.0) * GaugeFactor::kSigma);
}

TEST_F(FilledWindow, LandmarksAreWhereTheirSigmaSays) {
  WindowEstimate estimate;
  for (int i = 0; i < 10; ++i) {
    estimate = add_next();
  }
  int often_seen = 0;
  int within = 0;
  const Pose T_body_odom = inverse(estimate.keyframes.back().state.T_odom_body);
  const Pose T_body_room = inverse(run_.truth(estimate.keyframes.back().stamp).T_odom_body);
  for (const auto& [id, landmark] : estimate.landmarks) {
    ASSERT_GT(landmark.observations, 0);
    ASSERT_GT(landmark.relative_depth_sigma, 0.0);
    if (landmark.observations >= 3) {
      ++often_seen;
      const Eigen::Vector3d p_truth = T_body_room * run_.landmark(id);
      const Eigen::Vector3d p = T_body_odom * landmark.p_odom;
      const double depth = p_truth.norm();
      within += (p - p_truth).norm() < (3.0 * landmark.relative_depth_sigma + 0.01) * depth ? 1 : 0;
    }
  }
  EXPECT_GT(often_seen, 40);
  EXPECT_GT(within, 0.95 * often_seen);
}

TEST_F(FilledWindow, IsDeterministic) {
  SlidingWindow other(run_.stereo(), run_.noise(), config_, start_);
  for (int i = 0; i < 8; ++i) {
    const int frame = 40 + 6 * next_;
    const WindowEstimate second =
        other.add(keyframe_input(run_, frame, frame - 6, static_cast<std::uint32_t>(next_)));
    const WindowEstimate first = add_next();
    EXPECT_EQ(first.covariance, second.covariance);
    EXPECT_EQ(first.keyframes.back().state.T_odom_body.p,
              second.keyframes.back().state.T_odom_body.p);
  }
}

}  // namespace
}  // namespace fleetloc
