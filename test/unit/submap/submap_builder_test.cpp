#include "robot/submap/submap_builder.hpp"

#include <algorithm>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "deploy/config/default_config.hpp"
#include "shared/wire/submap_codec.hpp"
#include "test/unit/submap/default_builder.hpp"
#include "test/unit/submap/simulated_window.hpp"

namespace fleetloc {
namespace {

const SimulatedKeyframes& keyframes() {
  static const SimulatedKeyframes simulated(simulated_run(3, true), {}, 20, 1);
  return simulated;
}

/// Each landmark is seen in all keyframes.
SubmapInput input_at(std::size_t first, std::size_t count = kWindow) {
  SubmapInput input{.inertial = keyframes().window(first, count), .keyframes = {}, .landmarks = {}};
  for (std::size_t i = 0; i < count; ++i) {
    SubmapInputKeyframe keyframe{.id = KeyframeId{static_cast<std::uint32_t>(first + i)},
                                 .stamp = keyframe_stamp(static_cast<int>(first + i)),
                                 .tilt_sigma = 0.01,
                                 .observations = {}};
    for (std::uint32_t id = 0; id < 100; ++id) {
      keyframe.observations.push_back({LandmarkId{id}, {7.0 * id, 5.0 * (id % 90)}, 4.0});
    }
    input.keyframes.push_back(keyframe);
  }
  for (std::uint32_t id = 0; id < 100; ++id) {
    input.landmarks.push_back(
        {LandmarkId{id}, {1.0, 2.0, 0.1 * id}, static_cast<int>(count), id == 50 ? 10.0 : 0.01});
  }
  return input;
}

void expect_same(const VirtualEdge& a, const VirtualEdge& b) {
  EXPECT_EQ(a.from, b.from);
  EXPECT_EQ(a.to, b.to);
  EXPECT_EQ(a.revision, b.revision);
  EXPECT_EQ(a.T_from_to.p, b.T_from_to.p);
  EXPECT_EQ(a.T_from_to.R.coeffs(), b.T_from_to.R.coeffs());
  EXPECT_EQ(a.information, b.information);
}

TEST(SubmapBuilder, HoldsTheWindowWithAnEdgeBetweenEachTwoKeyframes) {
  SubmapBuilder builder(default_builder_config());
  const Submap submap = builder.build(input_at(0));
  ASSERT_EQ(submap.keyframes.size(), kWindow);
  ASSERT_EQ(submap.edges.size(), kWindow - 1);
  for (std::size_t i = 0; i + 1 < kWindow; ++i) {
    EXPECT_EQ(submap.edges[i].from, submap.keyframes[i].id);
    EXPECT_EQ(submap.edges[i].to, submap.keyframes[i + 1].id);
  }
  EXPECT_FALSE(builder.diagnostics().refusal);
  EXPECT_GT(builder.diagnostics().kl_divergence, 0.0);
}

bool is_accepted_by_the_codec(Submap submap) {
  submap.robot = "robot_1";
  return decode_submap(encode(submap)).has_value();
}

TEST(SubmapBuilder, IsAcceptedByTheCodec) {
  SubmapBuilder builder(default_builder_config());
  EXPECT_TRUE(is_accepted_by_the_codec(builder.build(input_at(0))));
}

TEST(SubmapBuilder, LeavesOutObservationsOfLandmarksThatAreNotSelected) {
  SubmapBuilder builder(default_builder_config());
  const Submap submap = builder.build(input_at(0));
  const int most = default_builder_config().landmarks.max_per_keyframe;
  EXPECT_EQ(submap.landmarks.size(), static_cast<std::size_t>(most));
  EXPECT_EQ(builder.diagnostics().reliable_landmarks, 99);
  for (const SubmapKeyframe& keyframe : submap.keyframes) {
    ASSERT_EQ(keyframe.observations.size(), submap.landmarks.size());
    for (std::size_t i = 0; i < submap.landmarks.size(); ++i) {
      EXPECT_EQ(keyframe.observations[i].landmark, submap.landmarks[i].id);
      EXPECT_NE(keyframe.observations[i].landmark, LandmarkId{50});
    }
  }
}

// As the odometry does it: `landmark` out of all keyframes of the window.
void drop(LandmarkId landmark, SubmapInput& input) {
  for (SubmapInputKeyframe& keyframe : input.keyframes) {
    std::erase_if(keyframe.observations,
                  [landmark](const auto& one) { return one.landmark == landmark; });
  }
  std::erase_if(input.landmarks, [landmark](const auto& one) { return one.id == landmark; });
}

bool sees(const SubmapKeyframe& keyframe, LandmarkId landmark) {
  return std::ranges::binary_search(
      keyframe.observations, landmark, {}, &StereoObservation::landmark);
}

TEST(SubmapBuilder, KeepsWhatItSentOfLandmarksThatTheOdometryMarginalizes) {
  SubmapBuilder builder(default_builder_config());
  const LandmarkId landmark = builder.build(input_at(0)).landmarks[3].id;
  SubmapInput input = input_at(1);  // keyframe 0, which saw the landmark, has left
  drop(landmark, input);
  const Submap submap = builder.build(input);
  for (std::size_t i = 0; i + 1 < kWindow; ++i) {
    EXPECT_TRUE(sees(submap.keyframes[i], landmark)) << i;
    EXPECT_EQ(submap.keyframes[i].revision, Revision{1}) << i;
  }
  EXPECT_FALSE(sees(submap.keyframes.back(), landmark));
  EXPECT_TRUE(is_accepted_by_the_codec(submap));
}

TEST(SubmapBuilder, HoldsALandmarkOnceThatWasMarginalizedAndIsSeenAgain) {
  SubmapBuilder builder(default_builder_config());
  const LandmarkId landmark = builder.build(input_at(0)).landmarks[3].id;
  SubmapInput input = input_at(1);
  drop(landmark, input);
  builder.build(input);
  const Submap submap = builder.build(input_at(2));
  EXPECT_TRUE(sees(submap.keyframes.back(), landmark));
  EXPECT_TRUE(is_accepted_by_the_codec(submap));
}

TEST(SubmapBuilder, TakesBackWhatTheOdometryRejects) {
  SubmapBuilder builder(default_builder_config());
  SubmapInput input = input_at(0);
  const LandmarkId landmark = builder.build(input).landmarks[3].id;
  drop(landmark, input);
  for (const SubmapKeyframe& keyframe : builder.build(input).keyframes) {
    EXPECT_FALSE(sees(keyframe, landmark));
  }
}

TEST(SubmapBuilder, RevisionsIncreaseOnlyWhereTheContentChanged) {
  SubmapBuilder builder(default_builder_config());
  SubmapInput input = input_at(0);
  const Submap first = builder.build(input);
  const Submap repeated = builder.build(input);
  for (std::size_t i = 0; i < kWindow; ++i) {
    EXPECT_EQ(first.keyframes[i].revision, Revision{1});
    EXPECT_EQ(repeated.keyframes[i].revision, Revision{1});
  }
  for (std::size_t i = 0; i < repeated.edges.size(); ++i) {
    expect_same(repeated.edges[i], first.edges[i]);
  }
  input.inertial.states[7].T_odom_body.p.x() += 0.01;
  input.inertial.states[7].v_odom.x() += 0.1;
  const Submap changed = builder.build(input);
  EXPECT_EQ(changed.keyframes[6].revision, Revision{1});
  EXPECT_EQ(changed.keyframes[7].revision, Revision{2});
  EXPECT_EQ(changed.edges.back().revision, Revision{2});
}

TEST(SubmapBuilder, AFinalEdgeStaysAsItIs) {
  SubmapBuilder::Config config = default_builder_config();
  config.final_behind_edges = 6;
  SubmapBuilder builder(config);
  const Submap before = builder.build(input_at(0));
  for (const SubmapInput& input : {input_at(1), input_at(2, 9)}) {
    const Submap after = builder.build(input);
    const std::size_t left = 3 - static_cast<std::size_t>(after.keyframes.front().id);
    for (std::size_t i = 0; i < left; ++i) expect_same(after.edges[i], before.edges[3 - left + i]);
    EXPECT_GT(after.edges.back().revision, Revision{0});
  }
  const Submap last = builder.build(input_at(2));
  EXPECT_EQ(last.edges[3].revision, Revision{4});  // sent anew each time
}

TEST(SubmapBuilder, InflatesTheCovarianceOfEdges) {
  SubmapBuilder::Config config = default_builder_config();
  config.edge_covariance_inflation = 1.0;
  const VirtualEdge once = SubmapBuilder(config).build(input_at(0)).edges.front();
  config.edge_covariance_inflation = 3.0;
  const VirtualEdge inflated = SubmapBuilder(config).build(input_at(0)).edges.front();
  EXPECT_LE((3.0 * inflated.information - once.information).norm(), 1e-9 * once.information.norm());
}

TEST(SubmapBuilder, SendsNoNewEdgesWhenTheInertialInformationIsSingular) {
  SubmapBuilder builder(default_builder_config());
  SubmapInput input = input_at(0);
  input.inertial.oldest_covariance.setZero();
  const Submap submap = builder.build(input);
  EXPECT_EQ(builder.diagnostics().refusal, SparsificationRefusal::kSingularPrior);
  EXPECT_TRUE(submap.edges.empty());
  EXPECT_EQ(submap.keyframes.size(), kWindow);
  EXPECT_TRUE(builder.build(input_at(0, 2)).edges.empty());
  EXPECT_EQ(builder.diagnostics().refusal, SparsificationRefusal::kTooFewKeyframes);
}

TEST(SubmapBuilder, TiltHasAFloorAndCanBeSwitchedOff) {
  SubmapBuilder::Config config = default_builder_config();
  SubmapInput input = input_at(0);
  input.keyframes[0].tilt_sigma = 1e-5;
  input.keyframes[1].tilt_sigma = std::numeric_limits<double>::quiet_NaN();
  const Submap measured = SubmapBuilder(config).build(input);
  EXPECT_NEAR(measured.keyframes[0].tilt_sigma, 0.2 * std::numbers::pi / 180.0, 1e-12);
  EXPECT_EQ(measured.keyframes[1].tilt_sigma, kUnknownTiltRad);
  EXPECT_EQ(measured.keyframes[2].tilt_sigma, 0.01);
  config.use_tilt = false;
  const Submap off = SubmapBuilder(config).build(input);
  EXPECT_EQ(off.keyframes[0].tilt_sigma, kUnknownTiltRad);
}

}  // namespace
}  // namespace fleetloc
