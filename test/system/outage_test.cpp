// Localizers that die while robots depend on them: separate processes over DDS, in real time.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <iostream>
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
    served_before.insert(answers.front().localizer);
    EXPECT_EQ(answers.back().localizer, "localizer_2") << id;
    EXPECT_EQ(frames_of(folder_of(id)).back().state, "localized") << id;
    expect_honest_poses_throughout(id);
  }
  EXPECT_EQ(served_before.size(), 2) << "one localizer served them all: nothing was tried";
}

}  // namespace
}  // namespace fleetloc
