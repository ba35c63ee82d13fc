#include "robot/uplink/delivery_record.hpp"

#include <gtest/gtest.h>

#include "test/unit/compact/moving_robot.hpp"

namespace fleetloc {
namespace {

constexpr double kLoss = 0.5;

class DeliveryRecordTest : public testing::Test {
 protected:
  void send(std::uint32_t number, ObservationSubset subset = {}) {
    record_.sent(SampleNumber{number}, drive_, subset);
  }
  void acknowledge(std::uint32_t base, std::uint64_t bitmap) {
    record_.acknowledged({.base = SampleNumber{base}, .bitmap = bitmap});
  }
  [[nodiscard]] double missing() const { return record_.missing(drive_.keyframes[0], kLoss); }

  Submap drive_ = moving_robot(100, 3);
  DeliveryRecord record_;
};

TEST_F(DeliveryRecordTest, WhatWasNeverSentIsMissing) {
  EXPECT_EQ(missing(), 1.0);
  EXPECT_EQ(record_.missing(drive_.edges[0], kLoss), 1.0);
}

TEST_F(DeliveryRecordTest, EachSendingLeavesTheLinksLoss) {
  send(1);
  EXPECT_DOUBLE_EQ(missing(), 0.5);
  send(2);
  EXPECT_DOUBLE_EQ(missing(), 0.25);
}

TEST_F(DeliveryRecordTest, AnAcknowledgedSampleHasArrivedAndAnOvertakenOneWasLost) {
  send(1);
  send(2);
  acknowledge(2, 1);
  EXPECT_EQ(missing(), 0.0);
  record_.clear();
  send(5);
  record_.sent(SampleNumber{6}, {}, {});
  acknowledge(6, 1);
  EXPECT_EQ(missing(), 1.0);
  acknowledge(5, 3);  // it was only late
  EXPECT_EQ(missing(), 0.0);
}

TEST_F(DeliveryRecordTest, AnOldAcknowledgementTellsNothingOfLaterSamples) {
  acknowledge(0, 1);
  send(3);
  acknowledge(0, 1);
  EXPECT_DOUBLE_EQ(missing(), 0.5);
}

// The odometry rejects some, and others take their place.
TEST_F(DeliveryRecordTest, ObservationsThatWereExchangedAreMissing) {
  send(1);
  acknowledge(1, 1);
  std::vector<StereoObservation>& now = drive_.keyframes[0].observations;
  ASSERT_GE(now.size(), 10U);
  const std::uint32_t last = static_cast<std::uint32_t>(now.back().landmark);
  const std::size_t exchanged = now.size() / 5;
  now.erase(now.begin(), now.begin() + static_cast<std::ptrdiff_t>(exchanged));
  for (std::uint32_t i = 1; i <= exchanged; ++i) {
    now.push_back(now.back());
    now.back().landmark = LandmarkId{last + i};
  }
  EXPECT_NEAR(missing(), 1.0 / 3.0, 0.02);  // of all that are in one of them
}

TEST_F(DeliveryRecordTest, HalfOfTheObservationsIsHalfOfAKeyframe) {
  send(1, {.stride = 2, .offset = 0});
  acknowledge(1, 1);
  EXPECT_DOUBLE_EQ(missing(), 0.5);
  send(2, {.stride = 2, .offset = 0});
  acknowledge(1, 3);
  EXPECT_DOUBLE_EQ(missing(), 0.5) << "the same half again";
  send(3, {.stride = 2, .offset = 1});
  acknowledge(1, 7);
  EXPECT_DOUBLE_EQ(missing(), 0.0);
}

TEST_F(DeliveryRecordTest, AKeyframeThatHasGrownIsMissingInParts) {
  send(1);
  acknowledge(1, 1);
  auto& observations = drive_.keyframes[0].observations;
  const std::size_t before = observations.size();
  observations.resize(2 * before);
  EXPECT_DOUBLE_EQ(missing(), 0.5);
}

TEST_F(DeliveryRecordTest, AFinalEdgeReplacesAProvisionalOne) {
  send(1);
  acknowledge(1, 1);
  EXPECT_EQ(record_.missing(drive_.edges[0], kLoss), 0.0);
  drive_.edges[0].is_final = true;
  EXPECT_GT(record_.missing(drive_.edges[0], kLoss), 0.1);
  send(2);
  acknowledge(1, 3);
  EXPECT_EQ(record_.missing(drive_.edges[0], kLoss), 0.0);
}

TEST_F(DeliveryRecordTest, ForgetsWhatIsBeforeTheOldestKeyframeAndNoMore) {
  send(1);
  acknowledge(1, 1);
  record_.forget_before(drive_.keyframes[1].id);
  EXPECT_EQ(record_.missing(drive_.keyframes[0], kLoss), 1.0);
  EXPECT_EQ(record_.missing(drive_.keyframes[1], kLoss), 0.0);
  EXPECT_EQ(record_.missing(drive_.edges[0], kLoss), 1.0) << "it begins at the one before";
  EXPECT_EQ(record_.missing(drive_.edges[1], kLoss), 0.0) << "it begins at the oldest";
}

TEST_F(DeliveryRecordTest, ReferencesCarryNoObservations) {
  drive_.keyframes[0].is_reference = true;
  send(1);
  acknowledge(1, 1);
  EXPECT_EQ(missing(), 1.0);
}

}  // namespace
}  // namespace fleetloc
