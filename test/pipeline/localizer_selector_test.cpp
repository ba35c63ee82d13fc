#include "robot/cloud_client/localizer_selector.hpp"

#include <set>

#include "test/pipeline/played_localizers.hpp"

namespace fleetloc {
namespace {

TEST_F(LocalizerSelectorTest, StaysWithALocalizerThatAnswers) {
  localizers_["a"] = {};
  play(1.0);
  localizers_["b"] = {};
  play(100.0);
  EXPECT_EQ(selector_.name(), "a");
  EXPECT_EQ(changes_, std::vector{Change::kChosen});
}

TEST_F(LocalizerSelectorTest, MovesWhenAnswersStopAndAvoidsTheSilentOne) {
  localizers_["a"] = {};
  play(5.0);
  localizers_["b"] = {};
  localizers_["a"].answers = false;
  play(9.5);
  EXPECT_EQ(selector_.name(), "b");
  localizers_["a"].answers = true;
  localizers_["b"].answers = false;
  play(13.9);
  EXPECT_EQ(selector_.name(), "b") << "a is still excluded";
  play(25.0);
  EXPECT_EQ(selector_.name(), "a");
}

TEST_F(LocalizerSelectorTest, LeavesADrainingLocalizerOnceAnotherOneAnswers) {
  localizers_["a"] = {};
  play(5.0);
  localizers_["a"].draining = true;
  play(8.0);
  EXPECT_EQ(selector_.name(), "a") << "nobody else takes robots";
  EXPECT_EQ(changes_.size(), 1);
  localizers_["b"] = {.answers = false};
  play(8.5);
  ASSERT_TRUE(selector_.successor().has_value()) << "begun at once";
  EXPECT_EQ(selector_.name(), "a") << "which still answers";
  localizers_["b"].answers = true;
  play(8.8);
  EXPECT_EQ(selector_.name(), "b");
  localizers_["a"] = {.incarnation = 2};
  play(30.0);
  EXPECT_EQ(selector_.name(), "b");
  EXPECT_EQ(changes_, (std::vector{Change::kChosen, Change::kSuccessor, Change::kChosen}));
}

// More names than are remembered, as of a flood: those that the robot uses are not forgotten.
TEST_F(LocalizerSelectorTest, MovesToASuccessorWhileHundredsOfOthersSpeak) {
  localizers_["a"] = {};
  play(5.0);
  localizers_["a"].draining = true;
  localizers_["b"] = {.answers = false};
  play(5.5);
  ASSERT_TRUE(selector_.successor().has_value());
  for (int i = 0; i < 600; ++i) {
    const LocalizerStatus other{.localizer = "x" + std::to_string(i),
                                .incarnation = Incarnation{1}};
    EXPECT_TRUE(selector_.update(other, at(5.6)));
  }
  selector_.decide(at(5.6), {});
  localizers_["b"].answers = true;
  play(8.0);
  EXPECT_EQ(selector_.name(), "b");
}

TEST_F(LocalizerSelectorTest, StaysWithALocalizerThatWasOnlySilentForAWhile) {
  localizers_["a"] = {};
  play(5.0);
  localizers_["a"].answers = false;
  localizers_["b"] = {.answers = false};
  play(8.0);
  ASSERT_TRUE(selector_.successor().has_value());
  localizers_["a"].answers = true;
  play(60.0);
  EXPECT_EQ(selector_.name(), "a");
  EXPECT_EQ(changes_, (std::vector{Change::kChosen, Change::kSuccessor, Change::kStays}));
}

TEST_F(LocalizerSelectorTest, TriesAFullLocalizerOnlyWhenItsOwnIsDead) {
  localizers_["a"] = {};
  play(5.0);
  localizers_["full"] = {.accepting = false};
  localizers_["a"].draining = true;
  play(10.0);
  EXPECT_EQ(selector_.name(), "a");
  localizers_["a"].answers = false;
  play(14.0);
  EXPECT_EQ(selector_.name(), "full");
}

TEST_F(LocalizerSelectorTest, TriesTheThirdWhenTheSecondDoesNotAnswerEither) {
  for (const char* name : {"a", "b", "c"}) localizers_[name] = {};
  play(5.0);
  const std::string chosen = selector_.name();
  const std::string second = selector_.standbys(1, at(now_s_)).front();
  localizers_[chosen].lives = false;
  localizers_[second].lives = false;
  play(12.0);
  EXPECT_NE(selector_.name(), chosen);
  EXPECT_NE(selector_.name(), second);
}

TEST_F(LocalizerSelectorTest, NoticesSilenceSoonerThanItWouldComeByLossAlone) {
  const auto noticed_s = [](double loss) {
    LocalizerSelector selector("robot", config());
    for (const char* name : {"a", "b"}) selector.update(status(name, {}), at(0));
    const LocalizerSelector::Link link{.round_trip = std::chrono::milliseconds(200), .loss = loss};
    selector.decide(at(0), link);
    selector.answered(at(1.0));
    selector.sent(at(1.5));
    for (int ms = 1500; ms < 60'000; ms += 10) {
      for (const char* name : {"a", "b"}) selector.update(status(name, {}), at(1e-3 * ms));
      if (selector.decide(at(1e-3 * ms), link) == Change::kSuccessor) return 1e-3 * ms - 1.5;
    }
    return 60.0;
  };
  EXPECT_NEAR(noticed_s(0.0), 1.6, 0.05);
  EXPECT_NEAR(noticed_s(0.5), 1.8, 0.1);
  EXPECT_NEAR(noticed_s(0.7), 3.1, 0.1);
  EXPECT_GT(noticed_s(0.9), 9.0);
}

TEST_F(LocalizerSelectorTest, StaysWithASilentLocalizerIfThereIsNoOther) {
  localizers_["a"] = {.answers = false};
  play(300.0);
  EXPECT_EQ(selector_.name(), "a");
  EXPECT_EQ(changes_.size(), 1);
}

TEST_F(LocalizerSelectorTest, MovesEverMoreRarelyAmongLocalizersThatNeverAnswer) {
  localizers_["a"] = {.answers = false};
  localizers_["b"] = {.answers = false};
  play(600.0);
  EXPECT_GE(changes_.size(), 4);
  EXPECT_LE(changes_.size(), 20);
}

TEST_F(LocalizerSelectorTest, FallsBackToAnExcludedLocalizerWhenItsOwnIsGone) {
  localizers_["a"] = {};
  localizers_["b"] = {.accepting = false};
  play(5.0);
  localizers_["b"].accepting = true;
  localizers_["a"].answers = false;
  play(9.5);
  ASSERT_EQ(selector_.name(), "b");
  localizers_["a"].answers = true;
  localizers_["b"].lives = false;
  play(18.0);
  EXPECT_EQ(selector_.name(), "a");
}

TEST_F(LocalizerSelectorTest, NoticesARestart) {
  localizers_["a"] = {};
  play(5.0);
  localizers_["a"].incarnation = 2;
  play(6.0);
  EXPECT_EQ(selector_.incarnation(), Incarnation{2});
  EXPECT_EQ(changes_.back(), Change::kRestarted);
}

TEST_F(LocalizerSelectorTest, BelievesALowerIncarnationOnceTheHigherOneIsSilent) {
  localizers_["a"] = {.incarnation = 9};
  play(5.0);
  localizers_["a"].incarnation = 2;  // the clock of its machine was set back
  play(6.0);
  EXPECT_EQ(selector_.incarnation(), Incarnation{9});
  play(15.0);
  EXPECT_EQ(selector_.incarnation(), Incarnation{2});
}

TEST_F(LocalizerSelectorTest, NamesTwoLiveLocalizersWithOneNameAndKeepsTheLaterOne) {
  std::set<std::string_view> reasons;
  for (int second = 0; second < 20; ++second) {
    const double s = second;
    EXPECT_TRUE(selector_.update(status("a", {.incarnation = 5}), at(s)));
    const auto taken = selector_.update(status("a", {.incarnation = 4}), at(s + 0.5));
    ASSERT_FALSE(taken.has_value());
    EXPECT_EQ(name(taken.error()), second == 0 ? "outdated_localizer" : "conflicting_localizer");
    selector_.decide(at(s + 0.6), {});
    EXPECT_EQ(selector_.incarnation(), Incarnation{5});
  }
}

TEST_F(LocalizerSelectorTest, KeepsToItsMapUntilThatReturns) {
  localizers_["a"] = {.map = 1};
  play(5.0);
  selector_.require_map({1});
  localizers_["a"] = {.incarnation = 2, .map = 2};
  play(10.0);
  EXPECT_EQ(selector_.name(), "");
  EXPECT_EQ(selector_.other_map(), "a");
  localizers_["a"] = {.incarnation = 3, .map = 1};
  play(11.0);
  EXPECT_EQ(selector_.name(), "a");
  EXPECT_EQ(selector_.incarnation(), Incarnation{3});
}

}  // namespace
}  // namespace fleetloc
