#include "deploy/evaluation/experiment/draw_trials.hpp"

#include <set>

#include <gmock/gmock.h>

#include "deploy/evaluation/experiment/place_tables.hpp"
#include "deploy/evaluation/experiment/run.hpp"
#include "test/unit/experiment/fake_programs.hpp"

namespace fleetloc {
namespace {

using testing::AllOf;
using testing::Each;
using testing::ElementsAreArray;
using testing::Ge;
using testing::HasSubstr;
using testing::Le;
using testing::Not;
using testing::ThrowsMessage;

std::string refusal_of(const std::string& text) {
  try {
    read_text(text);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "taken";
}

class PlanOfTrials : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::remove_all(test_folder() / "runs");
    std::filesystem::create_directories(test_folder() / "runs");
    write("calls", "");
    write_small_inputs();
    write("scene.yaml", "seasons: {summer: {}}\n");
    write("route.yaml", "\n");
  }

  static std::string with_starts(const std::string& starts) {
    return with(small_plan(), "folder: flight", "folder: flight, starts: {" + starts + "}");
  }
  static std::string with_carried(const std::string& carried) {
    return with(small_plan(),
                "folder: flight",
                "simulated: {scene: scene.yaml, route: route.yaml, season: summer, seed: 7, "
                "config: {sim: {images: {rate_hz: 10}}}}, carried: {" +
                    carried + "}");
  }
  static std::vector<std::string> lines_of_calls(const std::string& program) {
    std::ifstream calls(test_folder() / "calls");
    std::vector<std::string> found;
    for (std::string line; std::getline(calls, line);) {
      if (line.starts_with("fleetloc-" + program)) found.push_back(line);
    }
    return found;
  }
};

constexpr const char* kCarried =
    "count: 20, seed: 3, start_s: [5, 50], after_s: [10, 12], for_s: [4, 40], then_s: 30, "
    "reset: true";

TEST(DrawnStarts, AreThoseOfTheirSeedAndTheFirstOfMore) {
  StartsSpec starts{.count = 50, .seed = 4, .from_s = 3.0, .to_s = 100.0};
  const auto some = drawn_starts(starts);
  EXPECT_THAT(some, Each(AllOf(Ge(3.0), Le(100.0))));
  EXPECT_EQ(std::set(some.begin(), some.end()).size(), 50U);
  starts.count = 80;
  auto more = drawn_starts(starts);
  more.resize(50);
  EXPECT_THAT(more, ElementsAreArray(some));
  starts.seed = 5;
  EXPECT_NE(drawn_starts(starts).front(), some.front());
}

TEST_F(PlanOfTrials, HasARunForEachStartOfWhichTheRobotIsNotTold) {
  const Plan plan = read_text(with_starts("count: 5, seed: 1, from_s: 0, to_s: 1e-6"));
  const Programs programs = fake_programs();
  const Inputs inputs(plan, programs, test_folder());
  const auto runs = runs_of(plan, inputs, programs);
  ASSERT_EQ(runs.size(), 5U * 3U * 2U * 2U);
  EXPECT_NE(runs[0].identity, runs[1].identity);
  EXPECT_NE(runs[0].start_s, runs[1].start_s);
  EXPECT_THAT(runs[0].name(), HasSubstr(" from "));
  const RunContext context{
      .plan = &plan, .inputs = &inputs, .programs = &programs, .runs = test_folder() / "runs"};
  perform(runs[1], context, {}, 0);
  const auto replays = lines_of_calls("replay");
  ASSERT_EQ(replays.size(), 1U);
  EXPECT_THAT(replays[0], AllOf(HasSubstr("--start "), Not(HasSubstr("--initial-pose"))));
  const auto results = read_results(runs, context.runs);
  EXPECT_THAT(place_lines(results), HasSubstr("flight default ideal: starts 1, found 0"));
}

TEST_F(PlanOfTrials, CarriesARobotInEachRecordingAtAnotherTime) {
  const Plan plan = read_text(with_carried(kCarried));
  ASSERT_EQ(plan.datasets.size(), 20U);
  std::set<std::string> configs;
  for (std::size_t i = 0; i < plan.datasets.size(); ++i) {
    const DatasetSpec& trial = plan.datasets[i];
    EXPECT_EQ(trial.name, "flight_" + std::to_string(i + 1));
    EXPECT_EQ(trial.group, "flight");
    const auto& recording = std::get<SimulatedDataset>(trial.source);
    EXPECT_EQ(recording.seed, 7U + i);
    const double after_s = *recording.duration_s - 30.0;
    EXPECT_THAT(after_s, AllOf(Ge(10.0), Le(12.0)));
    EXPECT_THAT(recording.start_s, AllOf(Ge(5.0), Le(50.0)));
    auto sim = ConfigReader::from_string(recording.config).section("sim");
    EXPECT_EQ(sim.section("images").get<int>("rate_hz"), 10);
    EXPECT_NEAR(sim.section("carried").get<double>("at_s"), recording.start_s + after_s, 1e-6);
    EXPECT_THAT(sim.section("carried").get<double>("for_s"), AllOf(Ge(4.0), Le(40.0)));
    EXPECT_THAT(trial.faults, HasSubstr("kind: imu_gap"));
    configs.insert(recording.config);
  }
  EXPECT_EQ(configs.size(), 20U);
  const Plan without_reset = read_text(with(with_carried(kCarried), "reset: true", "reset: false"));
  EXPECT_EQ(without_reset.datasets[0].faults, "");
}

TEST_F(PlanOfTrials, LeavesAPartOfTheMapOut) {
  write("scan.ply", "points");
  const Plan plan = read_text(
      with(small_plan(), "{file: room.pcd}", "{cloud: scan.ply, without: [1, 2, 3.5, 4]}"));
  const Programs programs = fake_programs();
  const Inputs inputs(plan, programs, test_folder() / "store");
  const Plan whole = read_text(with(small_plan(), "{file: room.pcd}", "{cloud: scan.ply}"));
  const Inputs of_whole(whole, programs, test_folder() / "store");
  EXPECT_NE(inputs.map("room").identity, of_whole.map("room").identity);
  for (const Task& task : inputs.missing_maps()) task.run({}, 0);
  const auto maps = lines_of_calls("map");
  ASSERT_EQ(maps.size(), 1U);
  EXPECT_THAT(maps[0], HasSubstr("--without 1 2 3.5 4 --out "));
  std::filesystem::remove_all(test_folder() / "store");
}

TEST_F(PlanOfTrials, IsRefusedWhereItMakesNoSense) {
  EXPECT_THAT(refusal_of(with_starts("count: 0, seed: 1, from_s: 0, to_s: 1")),
              HasSubstr("starts.count"));
  EXPECT_THAT(refusal_of(with_starts("count: 2, seed: 1, from_s: 3, to_s: 1")),
              HasSubstr("starts.to_s"));
  EXPECT_THAT(refusal_of(with_carried(with(kCarried, "[4, 40]", "[40, 4]"))),
              HasSubstr("carried.for_s: must be [least, most]"));
  EXPECT_THAT(refusal_of(with(small_plan(),
                              "folder: flight",
                              std::string("folder: flight, carried: {") + kCarried + "}")),
              HasSubstr("carried: needs a simulated dataset"));
  EXPECT_THAT(refusal_of(with(
                  small_plan(), "{file: room.pcd}", "{cloud: room.pcd, without: [3, 2, 1, 4]}")),
              HasSubstr("without: must be [x_min, y_min, x_max, y_max]"));
}

}  // namespace
}  // namespace fleetloc
