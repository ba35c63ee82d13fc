#include "robot/cloud_client/known_localizers.hpp"

#include <map>

#include <gtest/gtest.h>

#include "test/unit/timestamps.hpp"

namespace fleetloc {
namespace {

LocalizerStatus status(const std::string& name, int sessions, double load = 0.0) {
  return {.localizer = name,
          .incarnation = Incarnation{1},
          .map_hash = {},
          .sessions = sessions,
          .load = load,
          .accepting = true};
}

constexpr KnownLocalizers::Config kConfig{
    .status_timeout_s = 35.0, .exclusion_s = 10.0, .max_exclusion_s = 30.0};

/// The one that a robot chooses; empty: none.
std::string chosen(const std::string& robot, const std::vector<LocalizerStatus>& statuses) {
  KnownLocalizers known(robot, kConfig);
  for (const LocalizerStatus& one : statuses) EXPECT_TRUE(known.update(one, {}, at(0.0)));
  const auto* best = known.best({}, at(0.0));
  return best == nullptr ? "" : best->status.localizer;
}

std::string robot(int number) {
  return "robot_" + std::to_string(number);
}

TEST(KnownLocalizers, AreChosenByTheirNumberOfRobotsWhereTheirLoadsAreAlike) {
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(chosen(robot(i), {status("a", 1), status("b", 0)}), "b");
    EXPECT_EQ(chosen(robot(i), {status("a", 1, 0.1), status("b", 0, 0.5)}), "a") << "by load first";
  }
}

TEST(KnownLocalizers, AreChosenEvenlyByAFleetWhereNumbersAreAlike) {
  std::map<std::string, int> robots;
  for (int i = 0; i < 300; ++i) {
    ++robots[chosen(robot(i), {status("a", 20), status("b", 22), status("c", 24)})];
  }
  for (const char* name : {"a", "b", "c"}) EXPECT_GT(robots[name], 60) << name;
}

TEST(KnownLocalizers, AreNotChosenWhileTheyDrainOrAreFull) {
  LocalizerStatus draining = status("a", 0);
  draining.accepting = false;
  draining.draining = true;
  EXPECT_EQ(chosen("robot", {draining}), "");
  EXPECT_EQ(chosen("robot", {draining, status("b", 500, 0.7)}), "b");
}

TEST(KnownLocalizers, AreAvoidedForEverLongerAfterEachTimeout) {
  KnownLocalizers known("robot", kConfig);
  EXPECT_TRUE(known.update(status("a", 0), {}, at(0.0)));
  const auto avoided_s = [&](double from_s) {
    EXPECT_TRUE(known.update(status("a", 0), {}, at(from_s)));
    known.exclude("a", at(from_s));
    EXPECT_NE(known.best({}, at(from_s), KnownLocalizers::Range::kExcluded), nullptr)
        << "if there is no other";
    double s = from_s;
    while (known.best({}, at(s)) == nullptr) {
      EXPECT_TRUE(known.update(status("a", 0), {}, at(s)));
      s += 1.0;
    }
    return s - from_s;
  };
  EXPECT_EQ(avoided_s(0.0), 10.0);
  EXPECT_EQ(avoided_s(100.0), 20.0);
  EXPECT_EQ(avoided_s(200.0), 30.0);
  EXPECT_EQ(avoided_s(300.0), 30.0);
  known.answered("a");
  EXPECT_EQ(avoided_s(400.0), 10.0);
}

TEST(KnownLocalizers, AreForgottenInTheOrderOfTheirSilenceButForThoseInUse) {
  KnownLocalizers known("robot", kConfig);
  for (int i = 0; i < 300; ++i) {
    EXPECT_TRUE(known.update(status("l" + std::to_string(i), 0), {"l0", "l1"}, at(0.01 * i)));
  }
  EXPECT_EQ(known.standbys(1000, "", at(3.0)).size(), 256);
  EXPECT_EQ(known.at("l0").status.localizer, "l0");
  EXPECT_EQ(known.at("l1").status.localizer, "l1");
}

}  // namespace
}  // namespace fleetloc
