#include "cloud/pool/fair_scheduler.hpp"

#include <map>
#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/unit/timestamps.hpp"

namespace fleetloc {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::IsEmpty;

class FairSchedulerTest : public testing::Test {
 protected:
  /// Gives the next robot a job of that length, and returns who it was; "nobody" if none waits.
  RobotId serve(int job_ms) {
    const auto turn = scheduler_.take();
    if (!turn) return "nobody";
    scheduler_.finish(*turn, milliseconds(job_ms));
    return turn->robot;
  }

  FairScheduler scheduler_{2.0};
};

TEST_F(FairSchedulerTest, RobotsThatHaveUsedAsMuchTakeTurns) {
  for (const char* robot : {"b", "a", "c"}) scheduler_.add(robot, at_ms(0));
  EXPECT_EQ(serve(10), "a");
  scheduler_.add("a", at_ms(1));
  EXPECT_EQ(serve(10), "b");
  EXPECT_EQ(serve(10), "c");
  EXPECT_EQ(serve(10), "a");
  EXPECT_EQ(serve(10), "nobody");
}

TEST_F(FairSchedulerTest, SharesTimeEvenlyWhateverTheJobsTake) {
  const std::map<RobotId, int> job_ms{{"quick", 10}, {"slow", 70}, {"slower", 150}};
  std::map<RobotId, int> used_ms;
  for (const auto& [robot, ms] : job_ms) scheduler_.add(robot, at_ms(0));
  for (int i = 0; i < 10'000; ++i) {
    const auto turn = scheduler_.take();
    ASSERT_TRUE(turn.has_value());
    scheduler_.finish(*turn, milliseconds(job_ms.at(turn->robot)));
    used_ms[turn->robot] += job_ms.at(turn->robot);
    scheduler_.add(turn->robot, at_ms(i));
  }
  EXPECT_NEAR(used_ms["quick"], used_ms["slow"], 150);
  EXPECT_NEAR(used_ms["slow"], used_ms["slower"], 150);
}

TEST_F(FairSchedulerTest, ARobotThatAlwaysHasWorkDoesNotStarveTheOthers) {
  scheduler_.add("patient", at_ms(0));
  for (int i = 0; i < 3; ++i) {
    scheduler_.add("busy", at_ms(i));
    EXPECT_EQ(serve(1), i == 1 ? "patient" : "busy");
  }
}

TEST_F(FairSchedulerTest, ANewcomerStartsAtTheVirtualTime) {
  scheduler_.add("old", at_ms(0));
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(serve(50), "old");
    scheduler_.add("old", at_ms(i));
  }
  scheduler_.add("new", at_ms(100));
  EXPECT_EQ(serve(50), "new");
  scheduler_.add("new", at_ms(100));
  int turns_of_old = 0;
  for (int i = 0; i < 20; ++i) {
    const RobotId robot = serve(50);
    if (robot == "old") ++turns_of_old;
    scheduler_.add(robot, at_ms(i));
  }
  EXPECT_NEAR(turns_of_old, 10, 1) << "five seconds that it was not here are not made up for";
}

TEST_F(FairSchedulerTest, AnAbsenceSavesNoTimeUp) {
  for (const char* robot : {"a", "b"}) scheduler_.add(robot, at_ms(0));
  EXPECT_EQ(serve(10), "a");
  EXPECT_EQ(serve(10), "b");
  for (int i = 0; i < 50; ++i) {  // without a
    scheduler_.add("b", at_ms(i));
    EXPECT_EQ(serve(10), "b");
  }
  int turns_of_a = 0;
  for (int i = 0; i < 20; ++i) {
    for (const char* robot : {"a", "b"}) scheduler_.add(robot, at_ms(i));
    if (serve(10) == "a") ++turns_of_a;
  }
  EXPECT_NEAR(turns_of_a, 10, 1) << "half a second of work of b is not made up for";
}

TEST_F(FairSchedulerTest, ARobotHasOneTurnAtATime) {
  scheduler_.add("a", at_ms(0));
  const auto turn = scheduler_.take();
  ASSERT_TRUE(turn.has_value());
  EXPECT_TRUE(scheduler_.is_running("a"));
  scheduler_.add("a", at_ms(1));
  EXPECT_FALSE(scheduler_.take().has_value());
  scheduler_.finish(*turn, milliseconds(5));
  EXPECT_FALSE(scheduler_.is_running("a"));
  EXPECT_EQ(serve(1), "a");
}

TEST_F(FairSchedulerTest, WorkOfARobotThatHasStoppedSendingIsDropped) {
  scheduler_.add("a", at_ms(0));
  scheduler_.add("b", at_ms(0));
  scheduler_.add("b", at_ms(1000));  // still sends
  EXPECT_THAT(scheduler_.drop_stale(at_ms(2000)), IsEmpty());
  EXPECT_THAT(scheduler_.drop_stale(at_ms(2001)), ElementsAre("a"));
  EXPECT_THAT(scheduler_.drop_stale(at_ms(2001)), IsEmpty());
  EXPECT_EQ(serve(1), "b");
  EXPECT_EQ(serve(1), "nobody");
}

TEST_F(FairSchedulerTest, WorkThatWaitsForItsOwnRobotsJobIsNotStale) {
  scheduler_.add("a", at_ms(0));
  const auto turn = scheduler_.take();
  scheduler_.add("a", at_ms(10));
  EXPECT_THAT(scheduler_.drop_stale(at_ms(5000)), IsEmpty());
  scheduler_.finish(turn.value(), milliseconds(5000));
  EXPECT_THAT(scheduler_.drop_stale(at_ms(5000)), ElementsAre("a"));
}

TEST_F(FairSchedulerTest, DroppedWorkGetsNoTurn) {
  scheduler_.add("a", at_ms(0));
  scheduler_.drop_work("a");
  EXPECT_EQ(serve(1), "nobody");
  scheduler_.add("a", at_ms(1));
  EXPECT_EQ(serve(1), "a");
}

TEST_F(FairSchedulerTest, TheTurnOfAnErasedRobotEndsWithoutEffect) {
  scheduler_.add("a", at_ms(0));
  const auto earlier = scheduler_.take();
  scheduler_.erase("a");
  EXPECT_FALSE(scheduler_.is_running("a"));
  scheduler_.add("a", at_ms(1));  // it has come back
  const auto later = scheduler_.take();
  scheduler_.finish(earlier.value(), milliseconds(1000));
  EXPECT_TRUE(scheduler_.is_running("a"));
  scheduler_.finish(later.value(), milliseconds(10));
  scheduler_.add("a", at_ms(2));
  scheduler_.add("b", at_ms(2));
  EXPECT_EQ(serve(1), "b") << "a has used ten milliseconds";
}

/// The definition: looks at every robot.
class Scan {
 public:
  void add(const RobotId& robot, Timestamp now) {
    Robot& known = robots_[robot];
    if (!known.newest && !known.runs) known.used = std::max(known.used, virtual_time_);
    known.newest = now;
  }
  std::vector<RobotId> drop_stale(Timestamp now) {
    std::vector<RobotId> stale;
    for (auto& [id, robot] : robots_) {
      if (robot.runs || !robot.newest || now - *robot.newest <= std::chrono::seconds(2)) continue;
      robot.newest.reset();
      stale.push_back(id);
    }
    return stale;
  }
  std::optional<RobotId> take() {
    auto next = robots_.end();
    for (auto it = robots_.begin(); it != robots_.end(); ++it) {
      if (it->second.runs || !it->second.newest) continue;
      if (next == robots_.end() || it->second.used < next->second.used) next = it;
    }
    if (next == robots_.end()) return std::nullopt;
    next->second.runs = true;
    next->second.newest.reset();
    virtual_time_ = std::max(virtual_time_, next->second.used);
    return next->first;
  }
  void finish(const RobotId& robot, Duration used) {
    robots_.at(robot).runs = false;
    robots_.at(robot).used += used;
  }

 private:
  struct Robot {
    Duration used{};
    std::optional<Timestamp> newest;
    bool runs = false;
  };
  std::map<RobotId, Robot> robots_;
  Duration virtual_time_{};
};

TEST_F(FairSchedulerTest, ChoosesWhomAScanOfAllRobotsWould) {
  std::mt19937 random(3);
  Scan scan;
  std::vector<FairScheduler::Turn> running;
  for (int ms = 0; ms < 20'000; ++ms) {
    const RobotId robot = "robot_" + std::to_string(random() % 40);
    if (random() % 3 != 0) {
      scheduler_.add(robot, at_ms(ms));
      scan.add(robot, at_ms(ms));
    }
    if (random() % 50 == 0) {
      auto stale = scheduler_.drop_stale(at_ms(ms));
      std::ranges::sort(stale);
      EXPECT_EQ(stale, scan.drop_stale(at_ms(ms)));
    }
    if (running.size() < 4 && random() % 4 == 0) {
      const auto turn = scheduler_.take();
      const auto expected = scan.take();
      ASSERT_EQ(turn.has_value(), expected.has_value()) << ms;
      if (!turn) continue;
      ASSERT_EQ(turn->robot, *expected) << ms;
      running.push_back(*turn);
    } else if (!running.empty() && random() % 4 == 0) {
      const Duration used = milliseconds(1 + random() % 100);
      scheduler_.finish(running.front(), used);
      scan.finish(running.front().robot, used);
      running.erase(running.begin());
    }
  }
}

TEST_F(FairSchedulerTest, TheBackgroundHasTheTimeThatNobodyElseWants) {
  scheduler_.add_background("searching");
  scheduler_.add_background("lost");
  for (int i = 0; i < 3; ++i) {
    for (const char* robot : {"a", "b"}) scheduler_.add(robot, at_ms(i));
    EXPECT_EQ(serve(100), "a");
    EXPECT_EQ(serve(100), "b");
  }
  EXPECT_EQ(serve(10), "searching");
  scheduler_.add_background("searching");
  EXPECT_EQ(serve(10), "lost");
  EXPECT_EQ(serve(10), "searching");
  EXPECT_EQ(serve(10), "nobody");
}

TEST_F(FairSchedulerTest, TheBackgroundIsHeldAgainstNobody) {
  for (int i = 0; i < 100; ++i) {
    scheduler_.add_background("searching");
    EXPECT_EQ(serve(1000), "searching");
  }
  scheduler_.add("other", at_ms(0));
  scheduler_.add("searching", at_ms(0));
  EXPECT_EQ(serve(10), "other");
  scheduler_.add("other", at_ms(1));
  EXPECT_EQ(serve(10), "searching");
}

TEST_F(FairSchedulerTest, TimeInTheBackgroundIsNotSavedUp) {
  for (int i = 0; i < 100; ++i) {
    scheduler_.add("other", at_ms(i));
    EXPECT_EQ(serve(10), "other");
    scheduler_.add_background("searching");
    const auto turn = scheduler_.take();
    scheduler_.add("searching", at_ms(i));
    scheduler_.finish(*turn, milliseconds(10));
    if (i < 99) {
      EXPECT_EQ(serve(1), "searching");
    }
  }
  for (int i = 0; i < 4; ++i) {
    scheduler_.add("other", at_ms(200 + i));
    scheduler_.add("searching", at_ms(200 + i));
    EXPECT_EQ(serve(10), i % 2 == 0 ? "searching" : "other") << i;
  }
}

TEST_F(FairSchedulerTest, WorkTakesTheBackgroundWithIt) {
  scheduler_.add_background("a");
  scheduler_.add("a", at_ms(0));
  EXPECT_EQ(serve(10), "a");
  EXPECT_EQ(serve(10), "nobody");
  scheduler_.add("a", at_ms(1));
  scheduler_.add_background("a");
  EXPECT_EQ(serve(10), "a");
  EXPECT_EQ(serve(10), "nobody");
  scheduler_.add_background("a");
  scheduler_.erase("a");
  EXPECT_EQ(serve(10), "nobody");
}

}  // namespace
}  // namespace fleetloc
