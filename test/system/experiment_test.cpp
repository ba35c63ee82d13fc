// fleetloc-experiment on a world of its own: from a plan to results, and again.
#include <algorithm>
#include <fstream>

#include <gmock/gmock.h>

#include "test/system/child_program.hpp"

namespace fleetloc {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string plan(const std::string& duration_s) {
  const std::string worlds = std::string(FLEETLOC_SOURCE_DIR) + "/deploy/worlds/";
  const std::string way = "scene: " + worlds + "campus.yaml, route: " + worlds + "quad.yaml";
  return "title: small\nmode: replay\nduration_s: " + duration_s +
         "\nmaps:\n  quad:\n    surveys:\n      summer: {" + way +
         ", season: summer, duration_s: 6}\n"
         "datasets:\n  autumn:\n    map: quad\n    simulated: {" +
         way +
         ", season: autumn, seed: 2, duration_s: 8}\n"
         "configurations:\n  default: {}\nlinks:\n  poor: {loss: 0.01, latency_s: 0.1}\n"
         "seeds: [1, 2]\n";
}

class Experiment : public testing::Test {
 protected:
  Outcome run_plan(const std::string& text) {
    std::ofstream(folder_ / "plan.yaml") << text;
    return run(FLEETLOC_EXPERIMENT,
               {"--plan", (folder_ / "plan.yaml").string(), "--out", out_.string()});
  }

  ScratchFolder folder_;
  std::filesystem::path out_ = folder_ / "out";
};

TEST_F(Experiment, MakesWhatItNeedsOnceAndKeepsWhatIsFinished) {
  const Outcome first = run_plan(plan("8"));
  ASSERT_EQ(first.exit_code, 0) << first.errors;
  EXPECT_THAT(first.output, HasSubstr("2 runs, 2 to be made"));
  const std::string results = content_of(out_ / "results.csv");
  EXPECT_EQ(std::ranges::count(results, '\n'), 3);
  EXPECT_THAT(results, HasSubstr("\nautumn,quad,default,poor,2,0,0.01,0.1,"));
  EXPECT_THAT(content_of(out_ / "report.html"),
              AllOf(HasSubstr("<svg"), HasSubstr("aligned once"), Not(HasSubstr("{{"))));

  const Outcome again = run_plan(plan("8"));
  EXPECT_EQ(again.exit_code, 0) << again.errors;
  EXPECT_THAT(again.output, AllOf(HasSubstr("2 runs, 0 to be made"), Not(HasSubstr("dataset 1/"))));
  EXPECT_EQ(content_of(out_ / "results.csv"), results);

  const Outcome changed = run_plan(plan("7"));
  EXPECT_EQ(changed.exit_code, 0) << changed.errors;
  EXPECT_THAT(changed.output, AllOf(HasSubstr("2 to be made"), Not(HasSubstr("dataset 1/"))));
}

TEST_F(Experiment, RefusesABadPlanBeforeAnythingRuns) {
  std::string text = plan("8");
  text.replace(text.find("default: {}"), 11, "default: {config: {localizer: {window: few}}}");
  const Outcome outcome = run_plan(text);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.errors,
              AllOf(HasSubstr("plan.yaml:13: configurations.default.config.localizer.window"),
                    testing::Truly([](const std::string& errors) {
                      return std::ranges::count(errors, '\n') == 1;
                    })));
  EXPECT_FALSE(std::filesystem::exists(out_));
}

}  // namespace
}  // namespace fleetloc
