// Localizers that die while robots depend on them: separate processes over DDS, in real time.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/system/dds_fixture.hpp"
#include "test/system/run_watch.hpp"

namespace fleetloc {
namespace {

using std::chrono::seconds;
using ::testing::Ge;
using ::testing::Le;

using Interval = std::pair<Timestamp, Timestamp>;

bool within(Timestamp stamp, const std::vector<Interval>& intervals) {
  return std::ranges::any_of(intervals, [stamp](const Interval& interval) {
    return interval.first <= stamp && stamp <= interval.second;
  });
}

class DdsOutage : public DdsFixture {
 protected:
  void SetUp() override {
    if (kSanitized) GTEST_SKIP() << "sanitizers are too slow for real time";
    DdsFixture::SetUp();
  }

  /// The longest time between applied answers of the run so far, from `begin` on, and the time
  /// since the last one [s].
  [[nodiscard]] double longest_without_answer(const std::string& id, Timestamp begin) const {
    const auto run = folder_of(id);
    double longest_s = 0.0;
    Timestamp before = begin;
    for (const AnswerLine& answer : answers_of(run)) {
      if (!answer.applied || answer.arrival <= begin) continue;
      longest_s = std::max(longest_s, to_seconds(answer.arrival - before));
      before = answer.arrival;
    }
    return std::max(longest_s, to_seconds(frames_of(run).back().stamp - before));
  }

  /// Ends a localizer by SIGTERM and starts it again.
  /// @return the time that it took to end [s]
  double restart(const std::string& name, std::unique_ptr<ChildProgram>& localizer) {
    const auto begin = std::chrono::steady_clock::now();
    localizer->signal(SIGTERM);
    const Outcome outcome = localizer->wait();
    const double took_s = to_seconds(std::chrono::steady_clock::now() - begin);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
    EXPECT_TRUE(std::filesystem::exists(folder_of(name) / "sessions.json")) << name;
    localizer = std::make_unique<ChildProgram>(FLEETLOC_CLOUD, cloud(name));
    return took_s;
  }

  /// Poses for every frame from the first on, and never one that is wrong and sure of it.
  void expect_honest_poses_throughout(const std::string& id) const {
    const auto run = folder_of(id);
    const auto errors = run_errors(run, flight_);
    std::cout << id << ": " << errors.dump() << '\n';
    EXPECT_EQ(errors.at("confidence").at("confidently_wrong"), 0) << id;
    const auto frames = frames_of(run);
    const auto first = std::ranges::find_if(
        frames, [](const FrameLine& frame) { return frame.state != "initializing"; });
    EXPECT_TRUE(std::ranges::none_of(first, frames.end(), [](const FrameLine& frame) {
      return frame.state == "initializing";
    })) << id;
  }
};

TEST_F(DdsOutage, IsLocalizedAgainSoonAfterAKilledLocalizerIsBack) {
  const std::string id = "robot_1";
  auto localizer = std::make_unique<ChildProgram>(FLEETLOC_CLOUD, cloud("localizer_1"));
  ChildProgram robot_1(FLEETLOC_ROBOT, robot(id, {"--rate", "1"}));
  const auto run = folder_of(id);
  const Timestamp killed = wait_for_data(run, seconds(20));
  localizer->signal(SIGKILL);
  localizer->wait();
  const Timestamp restarted = wait_for_data(run, seconds(30));
  localizer = std::make_unique<ChildProgram>(FLEETLOC_CLOUD, cloud("localizer_1"));
  const Outcome outcome = robot_1.wait();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  std::cout << outcome.output;  // what the robot said of its localizer

  const auto answers = answers_of(run);
  const auto is_applied = [](const AnswerLine& answer) { return answer.applied; };
  const auto back = std::ranges::find_if(answers, [&](const AnswerLine& answer) {
    return answer.applied && answer.arrival > restarted;
  });
  ASSERT_NE(back, answers.end());
  const double silent_s = to_seconds(back->arrival - restarted);
  const auto frames = frames_of(run);
  const std::vector<Interval> up{{frames.front().stamp, killed}, {restarted, frames.back().stamp}};
  const auto sent = std::ranges::count_if(
      frames, [&](const FrameLine& frame) { return frame.keyframe && within(frame.stamp, up); });
  const auto applied = std::ranges::count_if(answers, is_applied);
  const double share = static_cast<double>(applied) / static_cast<double>(sent);
  std::cout << "first applied answer " << silent_s << " s after the restart; " << applied
            << " answers applied to " << sent << " submaps sent while it was up: " << share << '\n';
  EXPECT_THAT(silent_s, Le(5.0));
  EXPECT_THAT(share, Ge(0.6));
  EXPECT_EQ(frames.back().state, "localized");
  expect_honest_poses_throughout(id);
}

TEST_F(DdsOutage, ARollingRestartOfTwoLocalizersTakesNoAnswersAway) {
  const std::string id = "robot_1";
  std::map<std::string, std::unique_ptr<ChildProgram>> localizers;
  for (const char* name : {"localizer_1", "localizer_2"}) {
    localizers[name] = std::make_unique<ChildProgram>(FLEETLOC_CLOUD, cloud(name));
  }
  ChildProgram robot_1(FLEETLOC_ROBOT, robot(id, {"--rate", "1", "--duration", "42"}));
  const auto run = folder_of(id);
  Timestamp now = wait_for_data(run, seconds(16));
  const Timestamp begin = now - seconds(4);
  int data_s = 16;
  std::set<std::string> restarted;
  while (restarted.size() < localizers.size()) {  // the one that serves the robot first
    std::string name = answers_of(run).back().localizer;
    if (restarted.contains(name)) {
      name = name == "localizer_1" ? "localizer_2" : "localizer_1";
    }
    const double took_s = restart(name, localizers.at(name));
    std::cout << name << " ended " << took_s << " s after SIGTERM\n";
    EXPECT_THAT(took_s, Le(4.0)) << "its robot had left";
    restarted.insert(name);
    now = wait_for_data(run, seconds(data_s += 9));
  }
  const Outcome outcome = robot_1.wait();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  std::cout << outcome.output;
  std::set<std::string> served;
  for (const AnswerLine& answer : answers_of(run)) {
    if (answer.arrival > begin) served.insert(answer.localizer);
  }
  EXPECT_EQ(served.size(), 2) << "nothing was tried";
  const double longest_s = longest_without_answer(id, begin);
  std::cout << "without an answer for " << longest_s << " s at most\n";
  EXPECT_THAT(longest_s, Le(1.5));
  expect_honest_poses_throughout(id);
}

TEST_F(DdsOutage, ARobotStaysWithADrainingLocalizerThatIsAloneUntilASecondSignalEndsIt) {
  const std::string id = "robot_1";
  ChildProgram localizer(FLEETLOC_CLOUD, cloud("localizer_1"));
  ChildProgram robot_1(FLEETLOC_ROBOT, robot(id, {"--rate", "1", "--duration", "30"}));
  const auto run = folder_of(id);
  const Timestamp stopped = wait_for_data(run, seconds(14));
  localizer.signal(SIGTERM);
  wait_for_data(run, seconds(18));
  EXPECT_THAT(longest_without_answer(id, stopped), Le(1.5)) << "it still answers";
  const auto begin = std::chrono::steady_clock::now();
  localizer.signal(SIGTERM);
  EXPECT_EQ(localizer.wait().exit_code, 0);
  EXPECT_THAT(to_seconds(std::chrono::steady_clock::now() - begin), Le(2.0));
  EXPECT_TRUE(std::filesystem::exists(folder_of("localizer_1") / "sessions.json"));
  robot_1.signal(SIGTERM);
  EXPECT_EQ(robot_1.wait().exit_code, 0);
}

TEST_F(DdsOutage, FourRobotsAreLocalizedAtTheEndThoughOneOfTwoLocalizersWasKilled) {
  const std::vector<std::string> starts{"0", "3", "6", "9"};
  auto first = std::make_unique<ChildProgram>(FLEETLOC_CLOUD, cloud("localizer_1"));
  const ChildProgram second(FLEETLOC_CLOUD, cloud("localizer_2"));
  std::vector<std::unique_ptr<ChildProgram>> robots;
  robots.reserve(starts.size());
  for (const std::string& start : starts) {
    robots.push_back(std::make_unique<ChildProgram>(
        FLEETLOC_ROBOT, robot("robot_" + start, {"--rate", "1", "--duration", "34"}, start)));
  }
  for (const std::string& start : starts) wait_for_data(folder_of("robot_" + start), seconds(16));
  std::map<std::string, Timestamp> killed;
  for (const std::string& start : starts) {
    killed["robot_" + start] = frames_of(folder_of("robot_" + start)).back().stamp;
  }
  first->signal(SIGKILL);
  first->wait();

  std::set<std::string> served_before;
  for (std::size_t i = 0; i < robots.size(); ++i) {
    const std::string id = "robot_" + starts[i];
    const Outcome outcome = robots[i]->wait();
    EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
    std::cout << outcome.output;
    const auto answers = answers_of(folder_of(id));
    ASSERT_FALSE(answers.empty()) << id;
    const auto last_before = std::ranges::find_if(
        answers, [&](const AnswerLine& answer) { return answer.arrival > killed.at(id); });
    served_before.insert(std::prev(last_before)->localizer);
    const double longest_s = longest_without_answer(id, killed.at(id));
    std::cout << id << ": without an answer for " << longest_s << " s at most\n";
    EXPECT_THAT(longest_s, Le(4.0)) << id;
    EXPECT_EQ(answers.back().localizer, "localizer_2") << id;
    EXPECT_EQ(frames_of(folder_of(id)).back().state, "localized") << id;
    expect_honest_poses_throughout(id);
  }
  EXPECT_EQ(served_before.size(), 2) << "one localizer served them all: nothing was tried";
}

}  // namespace
}  // namespace fleetloc
