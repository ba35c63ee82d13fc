// A fleet on a pool of localizers: how it spreads, and what it notices of restarts and failures.
#include <algorithm>
#include <cstdio>
#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "shared/core/percentile.hpp"
#include "test/pipeline/simulated_fleet.hpp"

namespace fleetloc {
namespace {

LinkConfig link_with(double loss, std::uint64_t seed) {
  LinkConfig link = perfect_link();
  for (LinkDirection* direction : {&link.uplink, &link.downlink}) {
    direction->loss = loss;
    direction->delay_s = 0.05;
  }
  link.seed = seed;
  return link;
}

std::string robot(int number) {
  return "robot_" + std::to_string(number);
}

TEST(Fleet, TwoRobotsThatStartAtOneMomentEndUpOnDifferentLocalizers) {
  int together = 0;
  for (int pair = 0; pair < 20; ++pair) {
    SimulatedFleet fleet(link_with(0.0, 1));
    fleet.start("a");
    fleet.start("b");
    fleet.add_robot(robot(2 * pair));
    fleet.add_robot(robot(2 * pair + 1));
    fleet.play(2.0);
    if (fleet.sessions("a") != 1) ++together;
    fleet.play(58.0);
    EXPECT_EQ(fleet.sessions("a"), 1) << pair;
    EXPECT_EQ(fleet.sessions("b"), 1) << pair;
    const auto changes = [&] {
      return fleet.statistics(robot(2 * pair)).localizers_chosen +
             fleet.statistics(robot(2 * pair + 1)).localizers_chosen;
    };
    const auto before = changes();
    fleet.play(120.0);
    EXPECT_EQ(changes(), before) << "they stay there";
    EXPECT_LE(fleet.without_answer().back(), 1.0);
  }
  std::printf("%d of 20 pairs began together\n", together);
  EXPECT_GT(together, 3) << "nothing was tried";
}

TEST(Fleet, ARobotThatComesLaterChoosesTheLocalizerWithFewerRobots) {
  for (int i = 0; i < 10; ++i) {
    SimulatedFleet fleet(link_with(0.0, 1));
    fleet.start("a");
    fleet.start("b");
    fleet.add_robot("first");
    fleet.play(5.0);
    fleet.add_robot(robot(i));
    fleet.play(2.0);
    EXPECT_EQ(fleet.sessions("a"), 1);
    EXPECT_EQ(fleet.sessions("b"), 1);
  }
}

class FleetOf : public testing::TestWithParam<double> {
 protected:
  static constexpr int kRobots = 40;
  static constexpr const char* kNames[] = {"a", "b", "c"};

  void begin(SimulatedFleet& fleet) const {
    for (const char* name : kNames) fleet.start(name);
    for (int i = 0; i < kRobots; ++i) fleet.add_robot(robot(i));
    fleet.play(30.0);
    fleet.count_anew();
  }
  [[nodiscard]] double changes(const SimulatedFleet& fleet) const {
    double sum = 0.0;
    for (int i = 0; i < kRobots; ++i) {
      sum += static_cast<double>(fleet.statistics(robot(i)).localizers_chosen);
    }
    return sum / kRobots;
  }
  static void expect_spread(const SimulatedFleet& fleet) {
    for (const char* name : kNames) {
      EXPECT_GE(fleet.sessions(name), kRobots / 3 * 2 / 3) << name;
      EXPECT_LE(fleet.sessions(name), kRobots / 3 * 3 / 2) << name;
      std::printf("%s: %d robots\n", name, fleet.sessions(name));
    }
  }
};

TEST_P(FleetOf, FortySpreadsAndThenRests) {
  SimulatedFleet fleet(link_with(GetParam(), 1));
  begin(fleet);
  fleet.play(60.0);
  expect_spread(fleet);
  const double before = changes(fleet);
  fleet.play(120.0);
  std::printf("%.2f localizers a robot, %.2f in the last 120 s\n", before, changes(fleet) - before);
  EXPECT_LE(before, 2.0);
  EXPECT_LE(changes(fleet) - before, GetParam() > 0.0 ? 0.3 : 0.05);
}

TEST_P(FleetOf, FortyNoticesNothingOfARollingRestart) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    SimulatedFleet fleet(link_with(GetParam(), seed));
    begin(fleet);
    const double usual_s = [&] {
      fleet.play(20.0);
      return fleet.without_answer().back();
    }();
    fleet.count_anew();
    for (const char* name : kNames) {
      fleet.stop(name);
      double waited_s = 0.0;
      for (; fleet.runs(name) && waited_s < 15.0; waited_s += 0.1) fleet.play(0.1);
      std::printf("%s ended after %.1f s\n", name, waited_s);
      EXPECT_LT(waited_s, GetParam() > 0.0 ? 11.0 : 3.0);
      fleet.start(name);
      fleet.play(5.0);
    }
    const double longest_s = fleet.without_answer().back();
    std::printf("seed %u: without an answer for %.2f s at most, usually %.2f s\n",
                static_cast<unsigned>(seed),
                longest_s,
                usual_s);
    EXPECT_LE(longest_s, GetParam() > 0.0 ? usual_s + 2.0 : 1.5);
    fleet.play(60.0);
    expect_spread(fleet);
  }
}

TEST_P(FleetOf, FortyLosesAKilledLocalizerForSeconds) {
  std::vector<double> missed_s;  // by those that it served
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    SimulatedFleet fleet(link_with(GetParam(), seed));
    begin(fleet);
    const auto served = static_cast<std::ptrdiff_t>(fleet.sessions("b"));
    fleet.kill("b");
    fleet.count_anew();
    fleet.play(12.0);
    const auto all_s = fleet.without_answer();
    missed_s.insert(missed_s.end(), all_s.end() - served, all_s.end());
    const int sessions = fleet.sessions("a") + fleet.sessions("c");
    EXPECT_GE(sessions, kRobots);
    EXPECT_LE(sessions, GetParam() > 0.0 ? kRobots + 2 : kRobots) << "farewells get lost";
  }
  const double half_s = percentile(missed_s, 0.5).value();
  const double most_s = percentile(missed_s, 0.95).value();
  const double longest_s = std::ranges::max(missed_s);
  std::printf(
      "%zu robots were without an answer: half of them for %.2f s, 95 %% for %.2f s, all for "
      "%.2f s\n",
      missed_s.size(),
      half_s,
      most_s,
      longest_s);
  EXPECT_LE(most_s, GetParam() > 0.0 ? 5.0 : 4.0);
  EXPECT_LE(longest_s, GetParam() > 0.0 ? 7.0 : 4.0);
}

TEST(Fleet, LossAloneRarelyMakesARobotBeginWithASuccessor) {
  for (const auto& [loss, most] : std::map<double, double>{{0.5, 1.0}, {0.7, 1.0}, {0.9, 1.0}}) {
    SimulatedFleet fleet(link_with(loss, 1));
    for (const char* name : {"a", "b"}) fleet.start(name);
    for (int i = 0; i < 10; ++i) fleet.add_robot(robot(i));
    fleet.play(60.0);
    const auto begun = [&] {
      double sum = 0.0;
      for (int i = 0; i < 10; ++i)
        sum += static_cast<double>(fleet.statistics(robot(i)).successors);
      return sum;
    };
    const double before = begun();
    fleet.play(300.0);
    const double a_minute = (begun() - before) / 10.0 / 5.0;
    std::printf("loss %.1f: %.2f successors a minute and robot\n", loss, a_minute);
    EXPECT_LE(a_minute, most);
  }
}

INSTANTIATE_TEST_SUITE_P(Loss, FleetOf, testing::Values(0.0, 0.5), [](const auto& one) {
  return "Of" + std::to_string(static_cast<int>(100.0 * one.param)) + "Percent";
});

// Each robot needs 4 % of a worker.
TEST(Fleet, AnOverloadedLocalizerTakesNoMoreRobotsWhereOthersDo) {
  SimulatedFleet fleet(link_with(0.0, 1), std::chrono::milliseconds(20));
  fleet.start("a");
  for (int i = 0; i < 22; ++i) fleet.add_robot(robot(i));
  fleet.play(20.0);
  EXPECT_EQ(fleet.sessions("a"), 22) << "there was no other";
  fleet.start("b");
  for (int i = 22; i < 32; ++i) fleet.add_robot(robot(i));
  fleet.play(2.0);
  EXPECT_EQ(fleet.sessions("b"), 10);
  fleet.play(120.0);
  std::printf("a: %d robots, b: %d robots\n", fleet.sessions("a"), fleet.sessions("b"));
  EXPECT_EQ(fleet.sessions("a") + fleet.sessions("b"), 32);
  EXPECT_LE(fleet.sessions("a"), 19);
  EXPECT_GE(fleet.sessions("a"), 13);
}

// Two of three at 60 % are killed: what is left is too busy to accept robots, but it is better than
// nothing.
TEST(Fleet, ABusyLocalizerTakesThoseWhoseOwnIsDead) {
  SimulatedFleet fleet(link_with(0.0, 1), std::chrono::milliseconds(20));
  for (const char* name : {"a", "b"}) fleet.start(name);
  for (int i = 0; i < 30; ++i) fleet.add_robot(robot(i));
  fleet.play(30.0);
  fleet.kill("a");
  fleet.play(20.0);
  EXPECT_EQ(fleet.sessions("b"), 30);
}

}  // namespace
}  // namespace fleetloc
