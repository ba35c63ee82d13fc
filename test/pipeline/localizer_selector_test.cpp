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
  config.status_timeout_s = 6.0;  // of localizers that tell their status as often as those here
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
    }
  }

  static LocalizerStatus status(const std::string& name, const Localizer& localizer) {
    return {.localizer = name,
            .incarnation = Incarnation{localizer.incarnation},
            .map_hash = {localizer.map},
            .sessions = 0,
            .load = localizer.load,
            .accepting = localizer.accepting};
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
