#include <random>

#include <gtest/gtest.h>

#include "shared/compact/answer_sample.hpp"
#include "shared/compact/correction_block.hpp"
#include "shared/compact/submap_block.hpp"
#include "shared/compact/submap_sample.hpp"
#include "test/unit/compact/moving_robot.hpp"
#include "test/unit/wire/samples.hpp"

namespace fleetloc {
namespace {

// What is accepted must be usable: finite, ordered and in range.
void expect_usable(const Submap& submap) {
  ASSERT_FALSE(submap.keyframes.empty());
  for (std::size_t i = 0; i < submap.keyframes.size(); ++i) {
    const SubmapKeyframe& keyframe = submap.keyframes[i];
    if (i > 0) {
      ASSERT_LT(submap.keyframes[i - 1].id, keyframe.id);
      ASSERT_LT(submap.keyframes[i - 1].stamp, keyframe.stamp);
    }
    ASSERT_TRUE(keyframe.T_odom_body.p.allFinite());
    ASSERT_NEAR(keyframe.T_odom_body.R.norm(), 1.0, 1e-9);
    ASSERT_GT(keyframe.tilt_sigma, 0.0);
    for (std::size_t k = 0; k < keyframe.observations.size(); ++k) {
      const StereoObservation& one = keyframe.observations[k];
      if (k > 0) {
        ASSERT_LT(keyframe.observations[k - 1].landmark, one.landmark);
      }
      ASSERT_GE(one.left.minCoeff(), 0.0);
      ASSERT_LT(one.left.maxCoeff(), kRectifiedSize);
      ASSERT_GE(one.disparity, 0.0);
    }
  }
  for (const VirtualEdge& edge : submap.edges) {
    ASSERT_LT(edge.from, edge.to);
    ASSERT_TRUE(edge.T_from_to.p.allFinite());
    ASSERT_TRUE(edge.information.allFinite());
    ASSERT_GT(edge.information.diagonal().minCoeff(), 0.0);
  }
}

TEST(CompactFuzz, AnySampleIsDecodedToSomethingUsableOrRefused) {
  std::mt19937 random(11);
  const Bytes good = encode_compact(moving_robot(100, 8), {}, {}, some_stereo());
  const SubmapSample sample = decode_submap_sample(good).value();
  int accepted = 0;
  for (int round = 0; round < 20'000; ++round) {
    SubmapSample changed = sample;
    const auto changes = 1 + random() % 4;
    for (std::uint32_t i = 0; i < changes; ++i) {
      changed.block[random() % changed.block.size()] ^=
          static_cast<std::uint8_t>(1U << (random() % 8));
    }
    if (round % 5 == 0) changed.block.resize(random() % changed.block.size());
    const auto decoded = decode_submap(changed, some_stereo());
    if (!decoded) continue;
    ++accepted;
    expect_usable(*decoded);
  }
  EXPECT_LT(accepted, 400);  // the end mark tells all but one garbled block in 256
}

TEST(CompactFuzz, RandomBlocksAreDecodedToSomethingUsableOrRefused) {
  std::mt19937 random(12);
  SubmapSample sample =
      decode_submap_sample(encode_compact(moving_robot(100, 3), {}, {}, some_stereo())).value();
  for (int round = 0; round < 20'000; ++round) {
    sample.block.resize(random() % 300);
    for (auto& byte : sample.block) byte = static_cast<std::uint8_t>(random());
    if (!sample.block.empty()) sample.block[0] = static_cast<std::uint8_t>(0x20 | (random() % 16));
    if (const auto decoded = decode_submap(sample, some_stereo())) expect_usable(*decoded);
  }
}

TEST(CompactFuzz, AnyAnswerIsDecodedOrRefused) {
  std::mt19937 random(13);
  const Bytes good = encode(Answer{some_answer(), some_correction()}, 1200);
  for (int round = 0; round < 20'000; ++round) {
    Bytes changed = good;
    const auto changes = 1 + random() % 4;
    for (std::uint32_t i = 0; i < changes; ++i) {
      changed[random() % changed.size()] ^= static_cast<std::uint8_t>(1U << (random() % 8));
    }
    if (round % 5 == 0) changed.resize(random() % changed.size());
    const auto decoded = decode_answer(changed);
    if (!decoded || !decoded->correction) continue;
    for (const auto& landmark : decoded->correction->landmarks) {
      ASSERT_TRUE(landmark.p_anchor.allFinite());
      ASSERT_TRUE(landmark.information.allFinite());
    }
    for (const auto& pose : decoded->correction->relative_poses) {
      ASSERT_LT(pose.from, pose.to);
      ASSERT_TRUE(pose.information.allFinite());
    }
  }
}

}  // namespace
}  // namespace fleetloc
