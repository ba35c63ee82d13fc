#include "deploy/evaluation/experiment/run.hpp"

#include <chrono>
#include <set>
#include <thread>

#include <gmock/gmock.h>

#include "test/unit/experiment/fake_programs.hpp"

namespace fleetloc {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// Runs of the small plan, in the order configuration (default, short, alone), link, seed.
class ExperimentRun : public testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(test_folder() / "runs");
    fs::create_directories(test_folder() / "runs");
    write("calls", "");
    write_small_inputs();
  }

  static std::vector<std::string> identities(const std::string& text,
                                             const Programs& programs = fake_programs()) {
    const Plan plan = read_text(text);
    const Inputs inputs(plan, programs, test_folder());
    std::vector<std::string> identities;
    for (const fleetloc::Run& run : runs_of(plan, inputs, programs))
      identities.push_back(run.identity);
    return identities;
  }

  static void expect_changed(const std::string& part, const std::string& other) {
    const auto before = identities(small_plan());
    const auto after = identities(with(small_plan(), part, other));
    ASSERT_EQ(before.size(), after.size());
    EXPECT_NE(before.front(), after.front()) << part;
  }

  /// Performs the first run. What is left of it, by the names of the entries.
  static std::string performed(const Programs& programs, const std::stop_token& stop = {}) {
    const Plan plan = read_text(small_plan());
    const Inputs inputs(plan, programs, test_folder());
    const fleetloc::Run run = runs_of(plan, inputs, programs).front();
    const RunContext context{
        .plan = &plan, .inputs = &inputs, .programs = &programs, .runs = test_folder() / "runs"};
    std::string line;
    try {
      line = perform(run, context, stop, 0);
    } catch (const Interrupted&) {
      line = "interrupted";
    }
    for (const auto& entry : fs::directory_iterator(test_folder() / "runs")) {
      const std::string name = entry.path().filename().string();
      if (entry.path() == finished_folder(context.runs, run)) {
        line += "|finished";
      } else {
        line += "|" + name.substr(name.find('.') + 1);
      }
    }
    return line;
  }
};

TEST_F(ExperimentRun, IsTheSameForTheSameInputsAlone) {
  const auto all = identities(small_plan());
  EXPECT_EQ(identities(small_plan()), all);
  // Odometry alone depends on neither link nor seed: its four runs are one.
  EXPECT_EQ(std::set(all.begin(), all.end()).size(), 4U + 4U + 1U);
}

TEST_F(ExperimentRun, IsAnotherOneForAnyOtherInput) {
  expect_changed("mode: replay", "mode: replay\nduration_s: 3");
  expect_changed("mode: replay", "mode: replay\nstart_s: 1e-7");
  expect_changed("mode: replay", "mode: replay\nstart_error: {position_m: 1, yaw_deg: 3}");
  expect_changed("default: {}", "default: {config: {localizer: {window: 11}}}");
  expect_changed("default: {}", "default: {align_once: true}");
  expect_changed("default: {}", "default: {baseline: icp}");
  expect_changed("default: {}",
                 "default: {localizers: {events: [{at_s: 0, localizer: l, event: start}]}}");
  expect_changed("ideal: {}", "ideal: {loss: 0.1}");
  expect_changed("ideal: {}", "ideal: {burst_length: 2}");
  expect_changed("ideal: {}", "ideal: {outages: [[10, 5]]}");
  expect_changed("[1, 2]", "[3, 2]");
}

TEST_F(ExperimentRun, OfTheBaselineDependsOnNoLink) {
  const std::string icp = with(small_plan(), "default: {}", "default: {baseline: icp}");
  EXPECT_EQ(identities(icp).front(),
            identities(with(icp, "ideal: {}", "ideal: {loss: 0.1}")).front());
  EXPECT_NE(identities(icp).front(), identities(with(icp, "[1, 2]", "[3, 2]")).front());
}

TEST_F(ExperimentRun, IsTheSameUnderAnotherName) {
  EXPECT_EQ(identities(with(small_plan(), "ideal:", "perfect:")), identities(small_plan()));
  EXPECT_EQ(identities(with(small_plan(), "title: small", "title: large")),
            identities(small_plan()));
}

TEST_F(ExperimentRun, FollowsDatasetMapAndProgram) {
  const auto before = identities(small_plan()).front();
  write("room.pcd", "other points");
  const auto map = identities(small_plan()).front();
  EXPECT_NE(map, before);
  write("flight/mav0/imu0/data.csv", "1000,0,0,0,0,0,0\n");
  const auto dataset = identities(small_plan()).front();
  EXPECT_NE(dataset, map);
  EXPECT_NE(identities(small_plan(), fake_programs("exit  0")).front(), dataset);
  fs::remove_all(test_folder() / "flight/mav0/imu0");
}

TEST_F(ExperimentRun, LeavesItsFolderOnlyWhenAllOfItIsThere) {
  EXPECT_THAT(
      performed(fake_programs()),
      AllOf(HasSubstr("error median 0.25 m"), HasSubstr("|finished"), Not(HasSubstr("part"))));
}

TEST_F(ExperimentRun, NeverShowsTheGroundTruthToAProgramUnderTest) {
  performed(fake_programs());
  std::ifstream calls(test_folder() / "calls");
  std::size_t replays = 0;
  for (std::string line; std::getline(calls, line);) {
    if (!line.starts_with("fleetloc-replay")) continue;
    ++replays;
    EXPECT_THAT(line,
                AllOf(HasSubstr("--initial-pose 1 2 3 0 0 0 1"),
                      HasSubstr("--map "),
                      Not(HasSubstr("groundtruth"))));
  }
  EXPECT_EQ(replays, 1U);
}

TEST_F(ExperimentRun, ThatFailedIsToldFromOneThatEndedWell) {
  EXPECT_EQ(performed(fake_programs("echo no map >&2; exit 4")), "failed: no map|failed");
  // Made again, well, nothing is left of the failure but under another program's hash.
  EXPECT_THAT(performed(fake_programs()), HasSubstr("|finished"));
}

TEST_F(ExperimentRun, HasFailedWhereItsProgramWasInterrupted) {
  const Programs programs =
      fake_programs("echo '{\"coverage\": 0.5, \"interrupted\": true}' > $out/summary.json");
  EXPECT_EQ(performed(programs), "failed: was interrupted before the end of the dataset|failed");
}

TEST_F(ExperimentRun, LeavesNothingWhenItIsInterrupted) {
  std::stop_source stop;
  const Programs programs = fake_programs("sleep 60");
  std::jthread stopper([&stop](const std::stop_token& done) {
    while (!done.stop_requested() && fs::is_empty(test_folder() / "runs")) {
      std::this_thread::yield();
    }
    stop.request_stop();
  });
  EXPECT_EQ(performed(programs, stop.get_token()), "interrupted");
}

TEST_F(ExperimentRun, TakesNothingOverFromAKilledOne) {
  const auto identity = identities(small_plan()).front();
  write("runs/" + identity + ".part/summary.json", "half");
  write("runs/" + identity + ".part/stray", "");
  EXPECT_THAT(performed(fake_programs()), HasSubstr("|finished"));
  EXPECT_FALSE(fs::exists(test_folder() / "runs" / identity / "stray"));
}

}  // namespace
}  // namespace fleetloc
