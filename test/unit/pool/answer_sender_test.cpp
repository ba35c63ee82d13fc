#include "cloud/pool/answer_sender.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "test/unit/timestamps.hpp"

namespace fleetloc {
namespace {

Answer some_answer() {
  LocalizationResult result;
  result.robot = "robot";
  result.localizer = "localizer";
  result.status = LocalizationStatus::kLocalized;
  result.covariance = Matrix6d::Identity();
  Correction correction;
  correction.landmarks.push_back({LandmarkId{1}, {1.0, 2.0, 3.0}, Eigen::Matrix3d::Identity()});
  return {result, correction};
}

class AnswerSenderTest : public testing::Test {
 protected:
  /// The answer that is due, if one is.
  std::optional<Answer> sent(double s) {
    const auto message = sender_.due(received_, at(s));
    if (!message) return std::nullopt;
    EXPECT_EQ((*message)->topic, Topic::kLocalization);
    return decode_answer((*message)->payload).value();
  }
  /// Answers sent from one time to another, looked for every 10 ms.
  int count(double from_s, double to_s) {
    int sum = 0;
    for (double s = from_s; s < to_s; s += 0.01) sum += sent(s) ? 1 : 0;
    return sum;
  }

  AnswerSender sender_{
      {.retransmission = {.max_interval_s = 1.0, .min_interval_s = 0.2, .full_rate_loss = 0.1},
       .repeated_for_s = 30.0,
       .max_payload_bytes = 480,
       .budget = {.max_bytes_per_s = 2000.0,
                  .max_bytes_per_s_high_loss = 4000.0,
                  .high_loss = 0.75,
                  .min_bytes_per_s = 300.0,
                  .burst_bytes = 2000.0,
                  .max_queueing_s = 0.2,
                  .increase_bytes_per_s2 = 100.0,
                  .decrease = 0.7,
                  .shortest_memory_s = 120.0,
                  .unmeasured_bytes_per_s = 1200.0,
                  .measured_for_s = 10.0}}};
  SubmapReceiver received_;
};

TEST_F(AnswerSenderTest, SendsNothingBeforeTheFirstAnswer) {
  EXPECT_FALSE(sent(0));
  EXPECT_FALSE(sender_.is_localized());
}

TEST_F(AnswerSenderTest, SendsAnAnswerWithItsCorrectionAtOnceAndNumbersIt) {
  sender_.set(some_answer());
  EXPECT_TRUE(sender_.is_localized());
  const auto first = sent(0);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->result.number, 1);
  EXPECT_TRUE(first->correction);
  EXPECT_FALSE(sent(0.1));
  sender_.set(some_answer());
  EXPECT_EQ(sent(0.1)->result.number, 2);
}

TEST_F(AnswerSenderTest, RepeatsTheMoreOftenTheMoreAnswersGetLost) {
  sender_.note({.newest = 0, .loss = 0.0, .age = {}}, {});
  sender_.set(some_answer());
  EXPECT_EQ(count(0.0, 3.9), 4);
  sender_.note({.newest = 0, .loss = 0.1, .age = {}}, {});
  sender_.set(some_answer());
  EXPECT_EQ(count(10.0, 12.9), 15);
}

TEST_F(AnswerSenderTest, RepeatsUntilTheRobotHasIt) {
  sender_.note({.newest = 0, .loss = 0.5, .age = {}}, {});
  sender_.set(some_answer());
  EXPECT_GT(count(0.0, 1.0), 3);
  sender_.note({.newest = 1, .loss = 0.5, .age = {}}, {});
  EXPECT_EQ(count(1.0, 5.0), 0);
}

// As to a robot that is parked, and sends nothing in which it could tell.
TEST_F(AnswerSenderTest, RepeatsNothingThatIsTooOldToHelp) {
  sender_.set(some_answer());
  EXPECT_GT(count(0.0, 30.0), 20);
  EXPECT_EQ(count(30.1, 60.0), 0);
  sender_.set(some_answer());
  EXPECT_TRUE(sent(61.0));
}

TEST_F(AnswerSenderTest, ReceiptsOfEarlierAnswersEndNothing) {
  sender_.set(some_answer());
  EXPECT_TRUE(sent(0));
  sender_.set(some_answer());
  sender_.note({.newest = 1, .loss = 0.5, .age = {}}, {});
  EXPECT_GT(count(1.0, 2.0), 3);
}

TEST_F(AnswerSenderTest, AReceiptOfAnAnswerThatWasNeverSentEndsNothing) {
  sender_.set(some_answer());
  EXPECT_TRUE(sent(0));
  sender_.note({.newest = 500, .loss = 0.5, .age = {}}, {});
  EXPECT_GT(count(1.0, 2.0), 3);
}

TEST_F(AnswerSenderTest, ALateReceiptBeginsNothingAgain) {
  sender_.set(some_answer());
  EXPECT_TRUE(sent(0));
  sender_.note({.newest = 1, .loss = 0.5, .age = {}}, {});
  sender_.note({.newest = 0, .loss = 0.5, .age = {}}, {});
  EXPECT_EQ(count(1.0, 3.0), 0);
}

TEST_F(AnswerSenderTest, ARepetitionAcknowledgesWhatHasArrivedAndTellsHowLongAgo) {
  received_.store(SampleNumber{5}, at(0.95));
  sender_.set(some_answer());
  EXPECT_EQ(sent(1.0)->result.holding_time, std::chrono::milliseconds(50));
  received_.store(SampleNumber{7}, at(2.5));
  received_.store(SampleNumber{6}, at(2.7));
  const auto again = sent(3.0);
  EXPECT_FALSE(again->correction);
  EXPECT_EQ(again->result.holding_time, std::chrono::milliseconds(500));
  EXPECT_EQ(again->result.acknowledgements.bitmap, 0b111U);
}

TEST_F(AnswerSenderTest, StaysWithinItsBudget) {
  sender_.note({.newest = 0, .loss = 0.5, .age = {}}, {});
  std::size_t bytes = 0;
  for (double s = 0.0; s < 60.0; s += 0.01) {
    if (static_cast<int>(100 * s + 0.5) % 10 == 0) sender_.set(some_answer());  // far too often
    const auto message = sender_.due(received_, at(s));
    if (message) bytes += (*message)->payload.size() + 100;
  }
  EXPECT_LT(static_cast<double>(bytes), 2000.0 * 62.0);
  EXPECT_GT(static_cast<double>(bytes), 1000.0 * 60.0);
}

TEST_F(AnswerSenderTest, SendsLessWhileTheDownlinkQueues) {
  std::uint32_t newest = 0;
  const auto rate_with_delay = [&](double from_s, double delay_s) {
    for (double s = from_s; s < from_s + 20.0; s += 0.5) {
      sender_.set(some_answer());
      newest = sent(s)->result.number;
      sender_.note({.newest = newest, .loss = 0.0, .age = std::chrono::milliseconds(100)},
                   at(s + delay_s + 0.1));
    }
    return sender_.budget().bytes_per_s();
  };
  EXPECT_EQ(rate_with_delay(0.0, 0.2), 2000.0);
  EXPECT_LT(rate_with_delay(30.0, 1.2), 1500.0);
}

TEST_F(AnswerSenderTest, WhatCannotBeEncodedIsDroppedAndNamed) {
  Answer answer = some_answer();
  answer.result.T_map_body.p.x() = std::numeric_limits<double>::infinity();
  sender_.set(answer);
  const auto message = sender_.due(received_, at(0));
  ASSERT_TRUE(message);
  EXPECT_EQ(message->error(), PoolRefusal::kNotEncodable);
  EXPECT_FALSE(sent(5));
}

TEST_F(AnswerSenderTest, NothingIsSentAfterAReset) {
  sender_.set(some_answer());
  sender_.reset();
  EXPECT_FALSE(sent(0));
}

}  // namespace
}  // namespace fleetloc
