#include "cloud/pool/answer_sender.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "shared/wire/localization_result_codec.hpp"

namespace fleetloc {
namespace {

Timestamp at(double s) {
  return Timestamp{from_seconds(s)};
}

LocalizationResult some_answer() {
  LocalizationResult answer;
  answer.robot = "robot";
  answer.localizer = "localizer";
  answer.status = LocalizationStatus::kLocalized;
  answer.covariance = Matrix6d::Identity();
  return answer;
}

Correction some_correction() {
  Correction correction;
  correction.robot = "robot";
  correction.localizer = "localizer";
  correction.landmarks.push_back({LandmarkId{1}, {1.0, 2.0, 3.0}, Eigen::Matrix3d::Identity()});
  return correction;
}

class AnswerSenderTest : public testing::Test {
 protected:
  AnswerSender sender_{{.max_interval_s = 1.0, .min_interval_s = 0.2, .full_rate_loss = 0.3}};
  SubmapReceiver received_;
};

TEST_F(AnswerSenderTest, SendsNothingBeforeTheFirstAnswer) {
  EXPECT_TRUE(sender_.due(received_, at(0)).empty());
  EXPECT_FALSE(sender_.is_localized());
}

TEST_F(AnswerSenderTest, SendsTheCorrectionOnceAndTheAnswerAgain) {
  sender_.set(some_answer(), some_correction());
  EXPECT_TRUE(sender_.is_localized());
  const auto first = sender_.due(received_, at(0));
  ASSERT_EQ(first.size(), 2);
  EXPECT_EQ(first[0]->topic, Topic::kLocalization);
  EXPECT_EQ(first[1]->topic, Topic::kCorrection);
  EXPECT_TRUE(sender_.due(received_, at(0.9)).empty());
  EXPECT_EQ(sender_.due(received_, at(1.0)).size(), 1);
}

TEST_F(AnswerSenderTest, ARepetitionAcknowledgesWhatHasArrivedMeanwhile) {
  sender_.set(some_answer(), std::nullopt);
  static_cast<void>(sender_.due(received_, at(0)));
  received_.store(SampleNumber{7});
  const auto again = sender_.due(received_, at(2));
  ASSERT_EQ(again.size(), 1);
  EXPECT_EQ(decode_localization_result(again[0]->payload).value().acknowledgements.base,
            SampleNumber{7});
}

TEST_F(AnswerSenderTest, WhatCannotBeEncodedIsDroppedAndNamed) {
  LocalizationResult answer = some_answer();
  answer.T_map_body.p.x() = std::numeric_limits<double>::infinity();
  Correction correction = some_correction();
  correction.landmarks[0].p_anchor.x() = 1e9;
  sender_.set(answer, correction);
  const auto messages = sender_.due(received_, at(0));
  ASSERT_EQ(messages.size(), 2);
  EXPECT_EQ(messages[0].error(), PoolRefusal::kNotEncodable);
  EXPECT_EQ(messages[1].error(), PoolRefusal::kCorrectionNotEncodable);
  EXPECT_TRUE(sender_.due(received_, at(5)).empty());
}

TEST_F(AnswerSenderTest, NothingIsSentAfterAReset) {
  sender_.set(some_answer(), some_correction());
  sender_.reset();
  EXPECT_TRUE(sender_.due(received_, at(0)).empty());
}

}  // namespace
}  // namespace fleetloc
