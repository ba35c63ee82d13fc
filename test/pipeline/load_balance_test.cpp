#include <map>
#include <utility>

#include "robot/cloud_client/localizer_selector.hpp"
#include "test/pipeline/played_localizers.hpp"

namespace fleetloc {
namespace {

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
