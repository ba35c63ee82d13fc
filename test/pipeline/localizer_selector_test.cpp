#include "robot/cloud_client/localizer_selector.hpp"

#include <map>
#include <set>

#include <gtest/gtest.h>

#include "deploy/config/default_config.hpp"
#include "shared/config/config_reader.hpp"

namespace fleetloc {
namespace {

using Change = LocalizerSelector::Change;

LocalizerSelector::Config config() {
  LocalizerSelector::Config config = read_localizer_selector_config(
      ConfigReader::from_string(default_config("robot")).section("client").section("selector"));
  config.known.status_timeout_s =
      6.0;  // of localizers that tell their status as often as those here
  return config;
}

Timestamp at(double s) {
  return Timestamp{from_seconds(s)};
}

class LocalizerSelectorTest : public testing::Test {
 protected:
  struct Localizer {
    std::uint32_t incarnation = 1;
    double load = 0.0;
    std::uint8_t map = 1;
    bool accepting = true;
    bool answers = true;
    bool lives = true;
    bool draining = false;
    int sessions = 0;
  };

  /// Status, submaps and answers, as they come.
  void play(double until_s) {
    for (; now_s_ < until_s; now_s_ += 0.1) {
      const Timestamp now = at(now_s_);
      for (const auto& [name, localizer] : localizers_) {
        if (localizer.lives) selector_.update(status(name, localizer), now);
      }
      const Change change = selector_.decide(now, {.round_trip = std::chrono::milliseconds(200)});
      if (change != Change::kNone) changes_.push_back(change);
      if (selector_.name().empty()) continue;
      selector_.sent(now);
      const Localizer& chosen = localizers_.at(selector_.name());
      if (chosen.lives && chosen.answers &&
          chosen.incarnation == static_cast<std::uint32_t>(selector_.incarnation())) {
        selector_.answered(now);
      }
      answer_as_successor(now);
    }
  }

  void answer_as_successor(Timestamp now) {
    if (!selector_.successor()) return;
    const Localizer& next = localizers_.at(selector_.successor()->name);
    if (!next.lives || !next.answers) return;
    selector_.take_over(now);
    selector_.answered(now);
    changes_.push_back(Change::kChosen);
  }

  static LocalizerStatus status(const std::string& name, const Localizer& localizer) {
    return {.localizer = name,
            .incarnation = Incarnation{localizer.incarnation},
            .map_hash = {localizer.map},
            .sessions = localizer.sessions,
            .load = localizer.load,
            .accepting = localizer.accepting && !localizer.draining,
            .draining = localizer.draining};
  }

  double now_s_ = 0.0;
  std::map<std::string, Localizer> localizers_;
  LocalizerSelector selector_{"robot", config()};
  std::vector<Change> changes_;
};

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

TEST_F(LocalizerSelectorTest, MovesForLoadOnceAndOnlyAfterAWhile) {
  localizers_["a"] = {.load = 0.95};
  play(5.0);
  localizers_["b"] = {.load = 0.2};
  play(20.0);
  EXPECT_EQ(selector_.name(), "a");
  play(60.0);
  EXPECT_EQ(selector_.name(), "b");
  localizers_["a"].load = 0.6;
  localizers_["b"].load = 0.7;
  play(300.0);
  EXPECT_EQ(selector_.name(), "b");
}

TEST_F(LocalizerSelectorTest, DoesNotMoveForALoadThatChangesAllTheTime) {
  localizers_["a"] = {.load = 0.95};
  play(5.0);
  localizers_["b"] = {.load = 0.2};
  for (int second = 10; second < 300; second += 10) {
    std::swap(localizers_["a"].load, localizers_["b"].load);
    play(second);
  }
  EXPECT_EQ(changes_.size(), 1);
}

TEST_F(LocalizerSelectorTest, GoesToItsFirstStandbyWhichNoLoadChanges) {
  for (const char* name : {"a", "b", "c", "d"}) localizers_[name] = {};
  localizers_["full"] = {.accepting = false};
  localizers_["elsewhere"] = {.map = 2};
  selector_.require_map({1});
  play(5.0);
  const std::string chosen = selector_.name();
  const auto standbys = selector_.standbys(2, at(now_s_));
  ASSERT_EQ(standbys.size(), 2);
  EXPECT_EQ(selector_.standbys(9, at(now_s_)).size(), 3);
  localizers_[standbys[1]].load = 0.5;
  play(6.0);
  EXPECT_EQ(selector_.standbys(2, at(now_s_)), standbys);
  localizers_[chosen].answers = false;
  play(11.0);
  EXPECT_EQ(selector_.name(), standbys[0]);
}

TEST_F(LocalizerSelectorTest, SpreadsAFleetOverEquallyLoadedLocalizers) {
  std::map<std::string, int> robots;
  for (int i = 0; i < 300; ++i) {
    LocalizerSelector selector("robot_" + std::to_string(i), config());
    for (const char* name : {"a", "b", "c"}) selector.update(status(name, {}), at(0));
    selector.decide(at(0), {});
    ++robots[selector.name()];
  }
  for (const char* name : {"a", "b", "c"}) EXPECT_GT(robots[name], 60) << name;
}

}  // namespace
}  // namespace fleetloc
