#include "robot/vio/initializer.hpp"

#include <set>

#include <gmock/gmock.h>

#include "robot/vio/inertial_alignment.hpp"
#include "test/unit/vio/simulated_vio.hpp"

namespace fleetloc {
namespace {

using ::testing::UnorderedElementsAre;

TEST(InertialAlignment, FindsGravityVelocitiesAndBiasesOfAnExactTrajectory) {
  SimulatedRun::Config config;
  config.initial_bias = {{0.05, -0.08, 0.03}, {0.05, -0.02, 0.04}};
  const SimulatedRun run(config);
  const Initialization truth = true_initialization(run, 40, 12, 4);
  std::vector<Pose> T_first_body;
  std::vector<Preintegration> between;
  const Pose T_first_room = inverse(truth.states.front().T_odom_body);
  for (std::size_t i = 0; i < truth.states.size(); ++i) {
    T_first_body.push_back(T_first_room * truth.states[i].T_odom_body);
    if (i > 0) {
      between.emplace_back(truth.keyframes[i].imu, ImuBias{}, run.noise());
    }
  }
  const InertialAlignment alignment = align_inertially(T_first_body, between, {1e-4, 0.1});
  EXPECT_LT((alignment.g_first - T_first_room.R * kGravity).norm(), 0.02);
  EXPECT_LT((alignment.bias.gyroscope - config.initial_bias.gyroscope).norm(), 1e-3);
  EXPECT_LT((alignment.bias.accelerometer - config.initial_bias.accelerometer).norm(), 0.03);
  EXPECT_NEAR(alignment.estimated_gravity, 9.81, 0.05);
  for (std::size_t i = 0; i < truth.states.size(); ++i) {
    EXPECT_LT((alignment.v_first[i] - T_first_room.R * truth.states[i].v_odom).norm(), 0.01);
  }
}

struct Start {
  const char* name;
  double rest_s;
  bool noise;
};

class InitializerTest : public testing::TestWithParam<Start> {};

TEST_P(InitializerTest, FindsStatesThatAreTrueUpToTheirCovariance) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    SimulatedRun::Config config;
    config.seed = seed;
    config.rest_s = GetParam().rest_s;
    config.initial_bias = {{-0.002, 0.021, 0.08}, {-0.02, 0.07, 0.05}};
    config.imu_white_noise = GetParam().noise;
    config.pixel_sigma = GetParam().noise ? 0.5 : 0.0;
    config.outlier_share = GetParam().noise ? 0.02 : 0.0;
    const SimulatedRun run(config);
    const PlayedRun played = play(run, simulated_vio_config(0.5), 2.4);
    ASSERT_TRUE(played.initialization.has_value()) << "seed " << seed;
    EXPECT_LT(played.initialized_s, 2.4);
    const Initialization& start = *played.initialization;
    EXPECT_EQ(start.keyframes.size(), start.states.size());
    EXPECT_TRUE(start.keyframes.front().imu.empty());
    const CheckedState& newest = played.keyframes.front();
    EXPECT_LT(newest.nees(), 45.0) << "seed " << seed;  // 15 dof, 99.99 %
    EXPECT_LT(newest.rotation_error(), 0.02) << "seed " << seed;
    ASSERT_TRUE(start.T_first_newest.has_value());
    const Vector6d error = local_coordinates(played.T_first_newest_truth, *start.T_first_newest);
    EXPECT_LT(error.norm(), GetParam().noise ? 0.05 : 0.005) << "seed " << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(Starts,
                         InitializerTest,
                         testing::Values(Start{"RestExact", 10.0, false},
                                         Start{"MotionExact", 0.0, false},
                                         Start{"RestNoisy", 10.0, true},
                                         Start{"MotionNoisy", 0.0, true}),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(Initializer, StartsOverAfterAGapOfTheImu) {
  const SimulatedRun run(SimulatedRun::Config{});
  const VioConfig config = simulated_vio_config(0.5);
  Initializer initializer(run.stereo(), run.noise(), config.initializer);
  for (int i = 0; i < 30; ++i) {
    const bool gap = i % 10 == 0;
    const KeyframeInput input = keyframe_input(run, i, gap ? -1 : i - 1, 0);
    EXPECT_EQ(initializer.add(input.frame, input.imu).error(), NotInitialized::kCollecting);
  }
}

/// Feeds frames from `first` on, until there is a result; `interrupt` may spoil one.
template <typename Interrupt>
std::optional<Initialization> initialized_from(int first,
                                               Initializer& initializer,
                                               const SimulatedRun& run,
                                               const Interrupt& interrupt) {
  for (int i = first; i < first + 60; ++i) {
    KeyframeInput input = keyframe_input(run, i, i - 1, 0);
    interrupt(i, input);
    if (auto result = initializer.add(input.frame, input.imu)) return *result;
  }
  return std::nullopt;
}

TEST(Initializer, DoesNotKnowTheMotionSinceTheFirstFrameAfterALossOfVision) {
  const SimulatedRun run(SimulatedRun::Config{});
  Initializer initializer(run.stereo(), run.noise(), simulated_vio_config(0.5).initializer);
  const auto result = initialized_from(0, initializer, run, [](int i, KeyframeInput& input) {
    if (i == 8) input.frame.observations.clear();
  });
  ASSERT_TRUE(result.has_value());
  EXPECT_GT(result->keyframes.front().frame.stamp, run.frame_stamp(7));
  EXPECT_FALSE(result->T_first_newest.has_value());
}

TEST(Initializer, DoesNotKnowTheMotionSinceTheFirstFrameAfterAGapOfTheImu) {
  const SimulatedRun run(SimulatedRun::Config{});
  Initializer initializer(run.stereo(), run.noise(), simulated_vio_config(0.5).initializer);
  const auto result = initialized_from(0, initializer, run, [](int i, KeyframeInput& input) {
    if (i == 8) input.imu.clear();
  });
  ASSERT_TRUE(result.has_value());
  EXPECT_FALSE(result->T_first_newest.has_value());
}

TEST(Initializer, CanBeUsedAgainLaterInTheFlight) {
  const SimulatedRun run(SimulatedRun::Config{});
  const Initializer::Config config = simulated_vio_config(0.5).initializer;
  const auto undisturbed = [](int, KeyframeInput&) {};
  Initializer used(run.stereo(), run.noise(), config);
  ASSERT_TRUE(initialized_from(0, used, run, undisturbed).has_value());
  Initializer fresh(run.stereo(), run.noise(), config);
  const auto again = initialized_from(100, used, run, undisturbed);
  const auto expected = initialized_from(100, fresh, run, undisturbed);
  ASSERT_TRUE(again.has_value() && expected.has_value());
  ASSERT_TRUE(again->T_first_newest.has_value());
  EXPECT_EQ(again->keyframes.back().frame.stamp, expected->keyframes.back().frame.stamp);
  EXPECT_EQ(again->states.back().T_odom_body.p, expected->states.back().T_odom_body.p);
  EXPECT_EQ(again->states.back().v_odom, expected->states.back().v_odom);
  const Pose T_first_newest = inverse(run.truth(run.frame_stamp(100)).T_odom_body) *
                              run.truth(again->keyframes.back().frame.stamp).T_odom_body;
  EXPECT_LT(local_coordinates(T_first_newest, *again->T_first_newest).norm(), 0.005);
}

TEST(Initializer, TakesFramesThatItWasNotGivenForAGap) {
  const SimulatedRun run(SimulatedRun::Config{});
  Initializer initializer(run.stereo(), run.noise(), simulated_vio_config(0.5).initializer);
  for (int i = 0; i < 10; ++i) {
    const KeyframeInput input = keyframe_input(run, i, i - 1, 0);
    EXPECT_FALSE(initializer.add(input.frame, input.imu).has_value());
  }
  const auto result = initialized_from(15, initializer, run, [](int, KeyframeInput&) {});
  ASSERT_TRUE(result.has_value());
  EXPECT_GE(result->keyframes.front().frame.stamp, run.frame_stamp(15));
  EXPECT_FALSE(result->T_first_newest.has_value());
}

TEST(Initializer, RefusesGravityThatIsNotGravity) {
  const SimulatedRun run(SimulatedRun::Config{});
  const VioConfig config = simulated_vio_config(0.5);
  Initializer initializer(run.stereo(), run.noise(), config.initializer);
  std::set<NotInitialized> reasons;
  for (int i = 0; i < 40; ++i) {
    KeyframeInput input = keyframe_input(run, i, i - 1, 0);
    for (ImuSample& sample : input.imu) {
      sample.specific_force *= 1.3;
    }
    reasons.insert(initializer.add(input.frame, input.imu).error());
  }
  EXPECT_THAT(
      reasons,
      UnorderedElementsAre(NotInitialized::kCollecting, NotInitialized::kImplausibleGravity));
}

}  // namespace
}  // namespace fleetloc
