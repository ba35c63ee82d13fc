#include "robot/cloud_client/answer_history.hpp"

#include <gtest/gtest.h>

#include "test/unit/timestamps.hpp"

namespace fleetloc {
namespace {

LocalizationResult answer(std::uint32_t keyframe) {
  LocalizationResult answer;
  answer.localizer = "a";
  answer.incarnation = Incarnation{1};
  answer.status = LocalizationStatus::kTooFewMatches;
  answer.keyframe = KeyframeId{keyframe};
  return answer;
}

LocalizationResult localized(std::uint32_t keyframe, double window_s) {
  LocalizationResult localized = answer(keyframe);
  localized.status = LocalizationStatus::kLocalized;
  localized.stamp = at(100.0);
  localized.oldest_stamp = at(100.0 - window_s);
  return localized;
}

Correction correction(std::uint32_t anchor) {
  Correction correction;
  correction.anchor = KeyframeId{anchor};
  return correction;
}

LocalizerSelector::Successor successor_since(double s) {
  LocalizerSelector::Successor successor;
  successor.since = at(s);
  return successor;
}

TEST(AnswerHistory, KnowsARepetitionHoweverManyAnswersAreBetween) {
  AnswerHistory history;
  for (std::uint32_t i = 0; i < 64; ++i) EXPECT_TRUE(history.add(answer(i), at(i)));
  for (std::uint32_t i = 0; i < 64; ++i) EXPECT_FALSE(history.add(answer(i), at(64)));
  history.start_session();
  EXPECT_TRUE(history.add(answer(0), at(65)));
}

TEST(AnswerHistory, TakesWhateverDiffersInAnythingForNew) {
  AnswerHistory history;
  EXPECT_TRUE(history.add(answer(1), at(0)));
  LocalizationResult other = answer(1);
  other.localizer = "b";
  EXPECT_TRUE(history.add(other, at(0)));
  other = answer(1);
  other.incarnation = Incarnation{2};
  EXPECT_TRUE(history.add(other, at(0)));
  other = answer(1);
  other.revision = Revision{1};
  EXPECT_TRUE(history.add(other, at(0)));
  EXPECT_TRUE(history.add(localized(1, 1.0), at(0)));
  EXPECT_FALSE(history.add(answer(1), at(0)));
}

TEST(AnswerHistory, GivesTheNewestCorrectionOnce) {
  AnswerHistory history;
  EXPECT_FALSE(history.take_correction());
  for (const std::uint32_t anchor : {5U, 8U, 7U}) history.add(correction(anchor));
  EXPECT_EQ(history.take_correction().value().anchor, KeyframeId{8});
  history.add(correction(8));
  EXPECT_FALSE(history.take_correction()) << "it has been taken";
  history.add(correction(9));
  history.start_session();
  EXPECT_FALSE(history.take_correction()) << "it was of the session before";
  history.add(correction(1));
  EXPECT_TRUE(history.take_correction());
}

TEST(AnswerHistory, RemembersTheMapOfTheNewestPoseAcrossSessions) {
  AnswerHistory history;
  history.add(answer(1), at(0));
  EXPECT_FALSE(history.map());
  LocalizationResult pose = localized(2, 1.0);
  pose.map_hash = {7};
  history.add(pose, at(1));
  history.start_session();
  EXPECT_EQ(history.map(), MapHash{7});
}

TEST(AnswerHistory, IsMatchedByAPoseFromAboutAsLongAWindow) {
  const LocalizerSelector::Successor successor = successor_since(0.5);
  AnswerHistory history;
  history.add(localized(1, 10.0), at(0));
  EXPECT_FALSE(history.is_matched_by(answer(2), successor, at(1)));
  EXPECT_FALSE(history.is_matched_by(localized(2, 7.9), successor, at(1)));
  EXPECT_TRUE(history.is_matched_by(localized(2, 8.1), successor, at(1)));
  EXPECT_FALSE(history.is_matched_by(localized(2, 1.0), successor, at(4.4)));
  EXPECT_TRUE(history.is_matched_by(localized(2, 1.0), successor, at(4.6))) << "after 4 s";
}

TEST(AnswerHistory, IsMatchedByAnyAnswerWhereNothingGetsWorse) {
  LocalizerSelector::Successor successor = successor_since(9.5);
  AnswerHistory history;
  EXPECT_TRUE(history.is_matched_by(answer(1), successor, at(9.6))) << "there was no pose";
  history.add(localized(1, 10.0), at(0));
  history.add(answer(2), at(9));  // no pose any more
  EXPECT_FALSE(history.is_matched_by(answer(3), successor, at(9.9)));
  EXPECT_TRUE(history.is_matched_by(answer(3), successor, at(10.1)));
  successor.is_urgent = true;
  EXPECT_TRUE(history.is_matched_by(answer(3), successor, at(9.9))) << "the old one is silent";
}

}  // namespace
}  // namespace fleetloc
