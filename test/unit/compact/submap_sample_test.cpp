#include "shared/compact/submap_sample.hpp"

#include <algorithm>

#include <gtest/gtest.h>
#include <idl/compact_submap.h>

#include "shared/wire/cdr.hpp"
#include "test/unit/compact/moving_robot.hpp"
#include "test/unit/wire/samples.hpp"

namespace fleetloc {
namespace {

/// With at most sixty observations a keyframe, so that all fit the block.
Submap some_drive(std::uint32_t first, int keyframes) {
  Submap submap = moving_robot(first, keyframes);
  for (auto& keyframe : submap.keyframes) {
    if (keyframe.observations.size() > 60) keyframe.observations.resize(60);
  }
  return submap;
}

Submap round_trip(const Submap& sent, const CompactPrecision& precision = {}) {
  const Bytes bytes = encode_compact(sent, {}, precision, some_stereo());
  return decode_submap(decode_submap_sample(bytes).value(), some_stereo()).value();
}

TEST(SubmapSample, TellsWhoseAndWhichItIs) {
  const Submap sent = some_drive(100, 4);
  const AnswerReceipt receipt{.newest = 77, .loss = 0.4, .age = std::chrono::milliseconds(1250)};
  const auto sample =
      decode_submap_sample(encode_compact(sent, receipt, {}, some_stereo())).value();
  EXPECT_EQ(sample.robot, sent.robot);
  EXPECT_EQ(sample.session, sent.session);
  EXPECT_EQ(sample.incarnation, sent.incarnation);
  EXPECT_EQ(sample.number, sent.number);
  EXPECT_EQ(sample.receipt.newest, 77U);
  EXPECT_NEAR(sample.receipt.loss, 0.4, 0.5 / 255.0);
  EXPECT_EQ(sample.receipt.age, std::chrono::milliseconds(1250));
  EXPECT_EQ(sample.keyframe, sent.keyframes.back().id);
  EXPECT_EQ(sample.stamp, sent.keyframes.back().stamp);
  EXPECT_EQ(header_of(sample).revision, revision_of(sent.number));
}

TEST(SubmapSample, RoundTripKeepsKeyframesToTheirSteps) {
  const Submap sent = some_drive(100, 10);
  const Submap received = round_trip(sent, {.subset = {}, .step_bits = 2});
  ASSERT_EQ(received.keyframes.size(), sent.keyframes.size());
  for (std::size_t k = 0; k < sent.keyframes.size(); ++k) {
    const SubmapKeyframe& a = received.keyframes[k];
    const SubmapKeyframe& b = sent.keyframes[k];
    EXPECT_EQ(a.id, b.id);
    EXPECT_EQ(a.revision, revision_of(sent.number));
    EXPECT_LE(std::chrono::abs(a.stamp - b.stamp), std::chrono::microseconds(500));
    expect_near(a.T_odom_body, b.T_odom_body, 6e-4, 0.51e-3);
    EXPECT_NEAR(std::log2(a.tilt_sigma / b.tilt_sigma), 0.0, 0.1251);
    EXPECT_EQ(a.pixel_step_px, 0.25);
    ASSERT_EQ(a.observations.size(), b.observations.size());
    for (std::size_t i = 0; i < b.observations.size(); ++i) {
      EXPECT_EQ(a.observations[i].landmark, b.observations[i].landmark);
      EXPECT_LE((a.observations[i].left - b.observations[i].left).cwiseAbs().maxCoeff(), 0.1251);
      EXPECT_EQ(a.observations[i].disparity == 0.0, b.observations[i].disparity == 0.0);
      EXPECT_NEAR(a.observations[i].disparity, b.observations[i].disparity, 0.1251);
    }
  }
  EXPECT_TRUE(received.landmarks.empty());
}

// The value to an eighth of its sigma along each axis, and sigmas to an eighth of an octave.
TEST(SubmapSample, RoundTripKeepsEdgesToAFractionOfTheirSigmas) {
  const Submap sent = some_drive(100, 10);
  const Submap received = round_trip(sent);
  ASSERT_EQ(received.edges.size(), sent.edges.size());
  for (std::size_t i = 0; i < sent.edges.size(); ++i) {
    const VirtualEdge& a = received.edges[i];
    const VirtualEdge& b = sent.edges[i];
    EXPECT_EQ(a.from, b.from);
    EXPECT_EQ(a.to, b.to);
    const Vector6d error = local_coordinates(b.T_from_to, a.T_from_to);
    EXPECT_LT(error.dot(b.information * error), 6 * 0.15 * 0.15) << i;
    for (Eigen::Index k = 0; k < 6; ++k) {
      EXPECT_NEAR(std::log2(a.information(k, k) / b.information(k, k)), 0.0, 0.26);
    }
  }
}

TEST(SubmapSample, EveryOtherObservationIsThatOfTheSubset) {
  const Submap sent = some_drive(100, 4);
  for (const std::uint32_t offset : {0U, 1U}) {
    const ObservationSubset subset{.stride = 2, .offset = offset};
    const Submap received = round_trip(sent, {.subset = subset, .step_bits = 1});
    for (std::size_t k = 0; k < sent.keyframes.size(); ++k) {
      const auto& all = sent.keyframes[k].observations;
      const auto wanted = std::ranges::count_if(
          all, [&](const auto& one) { return subset.has(one.landmark, sent.keyframes[k].id); });
      EXPECT_EQ(received.keyframes[k].observations.size(), static_cast<std::size_t>(wanted));
      EXPECT_EQ(received.keyframes[k].subset.offset, offset);
      EXPECT_EQ(received.keyframes[k].subset.stride, 2U);
      for (const auto& one : received.keyframes[k].observations) {
        EXPECT_TRUE(subset.has(one.landmark, received.keyframes[k].id));
      }
    }
  }
}

TEST(SubmapSample, KeyframesThatOnlyEdgesNeedAreNotDelivered) {
  Submap sent = some_drive(100, 6);
  sent.keyframes[0].is_reference = sent.keyframes[1].is_reference = true;
  const Submap received = round_trip(sent);
  ASSERT_EQ(received.keyframes.size(), 4U);
  EXPECT_EQ(received.keyframes[0].id, sent.keyframes[2].id);
  EXPECT_EQ(received.edges.size(), sent.edges.size());
}

TEST(SubmapSample, EdgesMaySkipKeyframes) {
  Submap sent = some_drive(100, 9);
  VirtualEdge wide = sent.edges[0];
  wide.to = sent.keyframes.back().id;
  wide.T_from_to = inverse(sent.keyframes.front().T_odom_body) * sent.keyframes.back().T_odom_body;
  sent.edges.push_back(wide);
  const Submap received = round_trip(sent);
  ASSERT_EQ(received.edges.size(), 9U);
  const auto found = std::ranges::find_if(received.edges, [&](const VirtualEdge& edge) {
    return edge.from == wide.from && edge.to == wide.to;
  });
  ASSERT_NE(found, received.edges.end());
  expect_near(found->T_from_to, wide.T_from_to, 1e-3, 2e-3);
}

// Half turns and jumps: what a chain of small steps would not have.
TEST(SubmapSample, HoldsKeyframesThatAreFarApart) {
  Submap sent = some_drive(4'000'000'000, 5);
  for (std::size_t i = 0; i < sent.keyframes.size(); ++i) {
    SubmapKeyframe& keyframe = sent.keyframes[i];
    keyframe.id = KeyframeId{static_cast<std::uint32_t>(1000 * i * i)};
    keyframe.stamp += std::chrono::hours(10 * i);
    keyframe.T_odom_body.p = {1e4 * static_cast<double>(i), -2e4, 300.0};
    keyframe.T_odom_body.R = Eigen::Quaterniond(
        Eigen::AngleAxisd(3.1 * static_cast<double>(i), Eigen::Vector3d::UnitX()));
  }
  sent.edges.clear();
  const Submap received = round_trip(sent);
  ASSERT_EQ(received.keyframes.size(), sent.keyframes.size());
  for (std::size_t i = 0; i < sent.keyframes.size(); ++i) {
    EXPECT_EQ(received.keyframes[i].id, sent.keyframes[i].id);
    expect_near(received.keyframes[i].T_odom_body, sent.keyframes[i].T_odom_body, 6e-4, 2e-3);
  }
}

TEST(SubmapSample, TheSameSubmapGivesTheSameBytes) {
  const Submap sent = some_drive(100, 10);
  EXPECT_EQ(encode_compact(sent, {}, {}, some_stereo()),
            encode_compact(sent, {}, {}, some_stereo()));
}

// What is decoded and encoded again: nothing is lost by a second rounding.
TEST(SubmapSample, DecodingIsStable) {
  Submap sent = some_drive(100, 6);
  const Submap once = round_trip(sent);
  Submap again = once;
  const Submap twice = round_trip(again);
  for (std::size_t k = 0; k < once.keyframes.size(); ++k) {
    ASSERT_EQ(once.keyframes[k].observations.size(), twice.keyframes[k].observations.size());
    for (std::size_t i = 0; i < once.keyframes[k].observations.size(); ++i) {
      EXPECT_EQ(once.keyframes[k].observations[i].left, twice.keyframes[k].observations[i].left);
    }
  }
}

TEST(SubmapSample, ThreeKeyframesFitHalfADatagram) {
  Submap sent = some_drive(100, 3);
  for (auto& keyframe : sent.keyframes) {
    if (keyframe.observations.size() > 80) keyframe.observations.resize(80);
  }
  EXPECT_LT(encode_compact(sent, {}, {}, some_stereo()).size(), 700U);
}

TEST(SubmapSample, RefusesToEncodeWhatTheReceiverWouldNotTake) {
  const auto change = [](auto corrupt) {
    Submap submap = some_drive(100, 3);
    corrupt(submap);
    EXPECT_THROW(encode_compact(submap, {}, {}, some_stereo()), NotEncodable);
  };
  change([](Submap& submap) { submap.robot = "?"; });
  change([](Submap& submap) { submap.keyframes.clear(); });
  change([](Submap& submap) { submap.keyframes[0].observations[0].left.x() = -1.0; });
  change([](Submap& submap) { submap.keyframes[0].observations[0].left.x() = 1e9; });
  change([](Submap& submap) { submap.keyframes[0].T_odom_body.p.x() = 1e9; });
  change([](Submap& submap) { submap.keyframes[0].stamp += std::chrono::hours(1); });
  change([](Submap& submap) { submap.edges[0].from = KeyframeId{1}; });
  change([](Submap& submap) { submap.edges[0].information.setZero(); });
}

TEST(SubmapSample, RefusesAnEnvelopeWithAReason) {
  const Bytes good = encode_compact(some_drive(100, 3), {}, {}, some_stereo());
  const auto expect_refused_sample = [&](Malformed reason, auto corrupt) {
    auto sample = from_cdr<wire::CompactSubmap>(good, 1).value();
    corrupt(sample);
    const auto decoded = decode_submap_sample(to_cdr(sample));
    ASSERT_FALSE(decoded.has_value());
    EXPECT_EQ(name(decoded.error()), name(reason));
  };
  using enum Malformed;
  expect_refused_sample(kInvalidId, [](auto& sample) { sample.robot("a b"); });
  expect_refused_sample(kNotFinite, [](auto& sample) {
    sample.p_odom()[1] = std::numeric_limits<float>::quiet_NaN();
  });
  expect_refused_sample(kNotARotation, [](auto& sample) { sample.rotation({0, 0, 0, 0}); });
  expect_refused_sample(
      kOutOfRange, [](auto& sample) { sample.stamp_ns(std::numeric_limits<std::int64_t>::max()); });
}

TEST(SubmapSample, RefusesABlockOfOtherSessionOrVersion) {
  auto sample =
      decode_submap_sample(encode_compact(some_drive(100, 5), {}, {}, some_stereo())).value();
  sample.block[0] ^= 0x80;  // the version
  EXPECT_FALSE(decode_submap(sample, some_stereo()).has_value());
}

}  // namespace
}  // namespace fleetloc
