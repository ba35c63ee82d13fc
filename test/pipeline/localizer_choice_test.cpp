#include "robot/cloud_client/localizer_choice.hpp"

#include <map>
#include <set>

#include <gtest/gtest.h>

#include "deploy/config/default_config.hpp"
#include "shared/config/config_reader.hpp"

namespace fleetloc {
namespace {

using Change = LocalizerChoice::Change;

LocalizerChoice::Config config() {
  return read_localizer_choice_config(
      ConfigReader::from_string(default_config("robot")).section("client").section("choice"));
}

Timestamp at(double s) {
  return Timestamp{from_seconds(s)};
}

class LocalizerChoiceTest : public testing::Test {
 protected:
  struct Localizer {
    std::uint32_t epoch = 1;
    double load = 0.0;
    std::uint8_t map = 1;
    bool accepting = true;
    bool answers = true;
    bool lives = true;
  };

  /// Status, submaps and answers, as they come.
  void play(double until_s) {
    for (; now_s_ < until_s; now_s_ += 0.1) {
      const Timestamp now = at(now_s_);
      for (const auto& [name, localizer] : localizers_) {
        if (localizer.lives) choice_.hear(status(name, localizer), now);
      }
      const Change change = choice_.decide(now, {.round_trip = std::chrono::milliseconds(200)});
      if (change != Change::kNone) changes_.push_back(change);
      if (choice_.name().empty()) continue;
      choice_.sent(now);
      const Localizer& chosen = localizers_.at(choice_.name());
      if (chosen.lives && chosen.answers &&
          chosen.epoch == static_cast<std::uint32_t>(choice_.epoch())) {
        choice_.answered(now);
      }
    }
  }

  static LocalizerStatus status(const std::string& name, const Localizer& localizer) {
    return {.localizer = name,
            .epoch = Epoch{localizer.epoch},
            .map_hash = {localizer.map},
            .sessions = 0,
            .load = localizer.load,
            .accepting = localizer.accepting};
  }

  double now_s_ = 0.0;
  std::map<std::string, Localizer> localizers_;
  LocalizerChoice choice_{"robot", config()};
  std::vector<Change> changes_;
};

TEST_F(LocalizerChoiceTest, StaysWithALocalizerThatAnswers) {
  localizers_["a"] = {};
  play(1.0);
  localizers_["b"] = {};
  play(100.0);
  EXPECT_EQ(choice_.name(), "a");
  EXPECT_EQ(changes_, std::vector{Change::kChosen});
}

TEST_F(LocalizerChoiceTest, MovesWhenAnswersStopAndAvoidsTheSilentOne) {
  localizers_["a"] = {};
  play(5.0);
  localizers_["b"] = {};
  localizers_["a"].answers = false;
  play(9.5);
  EXPECT_EQ(choice_.name(), "b");
  localizers_["a"].answers = true;
  localizers_["b"].answers = false;
  play(13.9);
  EXPECT_EQ(choice_.name(), "b") << "a is still excluded";
  play(25.0);
  EXPECT_EQ(choice_.name(), "a");
}

TEST_F(LocalizerChoiceTest, StaysWithASilentLocalizerIfThereIsNoOther) {
  localizers_["a"] = {.answers = false};
  play(300.0);
  EXPECT_EQ(choice_.name(), "a");
  EXPECT_EQ(changes_.size(), 1);
}

TEST_F(LocalizerChoiceTest, MovesEverMoreRarelyAmongLocalizersThatNeverAnswer) {
  localizers_["a"] = {.answers = false};
  localizers_["b"] = {.answers = false};
  play(600.0);
  EXPECT_GE(changes_.size(), 4);
  EXPECT_LE(changes_.size(), 20);
}

TEST_F(LocalizerChoiceTest, FallsBackToAnExcludedLocalizerWhenItsOwnIsGone) {
  localizers_["a"] = {};
  localizers_["b"] = {.accepting = false};
  play(5.0);
  localizers_["b"].accepting = true;
  localizers_["a"].answers = false;
  play(9.5);
  ASSERT_EQ(choice_.name(), "b");
  localizers_["a"].answers = true;
  localizers_["b"].lives = false;
  play(18.0);
  EXPECT_EQ(choice_.name(), "a");
}

TEST_F(LocalizerChoiceTest, NoticesARestart) {
  localizers_["a"] = {};
  play(5.0);
  localizers_["a"].epoch = 2;
  play(6.0);
  EXPECT_EQ(choice_.epoch(), Epoch{2});
  EXPECT_EQ(changes_.back(), Change::kRestarted);
}

TEST_F(LocalizerChoiceTest, BelievesALowerEpochOnceTheHigherOneIsSilent) {
  localizers_["a"] = {.epoch = 9};
  play(5.0);
  localizers_["a"].epoch = 2;  // the clock of its machine was set back
  play(6.0);
  EXPECT_EQ(choice_.epoch(), Epoch{9});
  play(15.0);
  EXPECT_EQ(choice_.epoch(), Epoch{2});
}

TEST_F(LocalizerChoiceTest, NamesTwoLiveLocalizersWithOneNameAndKeepsTheLaterOne) {
  std::set<std::string_view> reasons;
  for (int second = 0; second < 20; ++second) {
    const double s = second;
    EXPECT_FALSE(choice_.hear(status("a", {.epoch = 5}), at(s)));
    const auto reason = choice_.hear(status("a", {.epoch = 4}), at(s + 0.5));
    ASSERT_TRUE(reason.has_value());
    EXPECT_EQ(*reason, second == 0 ? "outdated_localizer" : "conflicting_localizer");
    choice_.decide(at(s + 0.6), {});
    EXPECT_EQ(choice_.epoch(), Epoch{5});
  }
}

TEST_F(LocalizerChoiceTest, KeepsToItsMapUntilThatReturns) {
  localizers_["a"] = {.map = 1};
  play(5.0);
  choice_.keep_to({1});
  localizers_["a"] = {.epoch = 2, .map = 2};
  play(10.0);
  EXPECT_EQ(choice_.name(), "");
  EXPECT_EQ(choice_.other_map(), "a");
  localizers_["a"] = {.epoch = 3, .map = 1};
  play(11.0);
  EXPECT_EQ(choice_.name(), "a");
  EXPECT_EQ(choice_.epoch(), Epoch{3});
}

TEST_F(LocalizerChoiceTest, MovesForLoadOnceAndOnlyAfterAWhile) {
  localizers_["a"] = {.load = 0.95};
  play(5.0);
  localizers_["b"] = {.load = 0.2};
  play(20.0);
  EXPECT_EQ(choice_.name(), "a");
  play(60.0);
  EXPECT_EQ(choice_.name(), "b");
  localizers_["a"].load = 0.6;
  localizers_["b"].load = 0.7;
  play(300.0);
  EXPECT_EQ(choice_.name(), "b");
}

TEST_F(LocalizerChoiceTest, DoesNotMoveForALoadThatChangesAllTheTime) {
  localizers_["a"] = {.load = 0.95};
  play(5.0);
  localizers_["b"] = {.load = 0.2};
  for (int second = 10; second < 300; second += 10) {
    std::swap(localizers_["a"].load, localizers_["b"].load);
    play(second);
  }
  EXPECT_EQ(changes_.size(), 1);
}

TEST_F(LocalizerChoiceTest, SpreadsAFleetOverEquallyLoadedLocalizers) {
  std::map<std::string, int> robots;
  for (int i = 0; i < 300; ++i) {
    LocalizerChoice choice("robot_" + std::to_string(i), config());
    for (const char* name : {"a", "b", "c"}) choice.hear(status(name, {}), at(0));
    choice.decide(at(0), {});
    ++robots[choice.name()];
  }
  for (const char* name : {"a", "b", "c"}) EXPECT_GT(robots[name], 60) << name;
}

}  // namespace
}  // namespace fleetloc
