#include "deploy/evaluation/experiment/results.hpp"

#include <sstream>

#include <gmock/gmock.h>

#include "deploy/evaluation/experiment/experiment_report.hpp"
#include "test/unit/experiment/fake_programs.hpp"

namespace fleetloc {
namespace {

using testing::HasSubstr;
using testing::SizeIs;

std::vector<std::string> fields(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream stream(line + ",");
  for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
  return fields;
}

class Results : public testing::Test {
 protected:
  Results()
      : programs_((write_small_inputs(), fake_programs())),
        plan_(read_text(small_plan())),
        inputs_(plan_, programs_, test_folder()),
        runs_(runs_of(plan_, inputs_, programs_)),
        context_{.plan = &plan_,
                 .inputs = &inputs_,
                 .programs = &programs_,
                 .runs = test_folder() / "results"} {
    std::filesystem::remove_all(context_.runs);
    std::filesystem::create_directories(context_.runs);
  }

  /// The field of a column in the first line of results.csv.
  [[nodiscard]] std::string first(const std::string& column) const {
    std::istringstream csv(results_csv(read_results(runs_, context_.runs)));
    std::string header;
    std::string line;
    std::getline(csv, header);
    std::getline(csv, line);
    const auto names = fields(header);
    const auto found = std::ranges::find(names, column);
    if (found == names.end()) return "no such column";
    return fields(line).at(static_cast<std::size_t>(found - names.begin()));
  }

  Programs programs_;
  Plan plan_;
  Inputs inputs_;
  std::vector<fleetloc::Run> runs_;
  RunContext context_;
};

TEST_F(Results, HaveARowForEachRunThatEnded) {
  EXPECT_THAT(read_results(runs_, context_.runs), SizeIs(0));
  perform(runs_[3], context_, {}, 0);  // default, poor, seed 2
  EXPECT_THAT(read_results(runs_, context_.runs), SizeIs(1));
  EXPECT_EQ(first("dataset"), "flight");
  EXPECT_EQ(first("configuration"), "default");
  EXPECT_EQ(first("link"), "poor");
  EXPECT_EQ(first("seed"), "2");
  EXPECT_EQ(first("loss_up"), "0.5");
  EXPECT_EQ(first("latency_down_s"), "2");
  EXPECT_EQ(first("ate_median_m"), "0.25");
  EXPECT_EQ(first("covered"), "0.75");
  EXPECT_EQ(first("coverage"), "0.5");
  EXPECT_EQ(first("optimize_p50_ms"), "7");
  EXPECT_EQ(first("exit_status"), "0");
  EXPECT_EQ(first("ate_std_m"), "");  // is not there
  EXPECT_EQ(first("resets"), "");     // is null
}

TEST_F(Results, NameTheFailureOfARun) {
  programs_ = fake_programs("echo 'bad, \"very\" bad' >&2; exit 4");
  perform(runs_[0], context_, {}, 0);
  EXPECT_EQ(first("exit_status"), "4");
  EXPECT_EQ(first("ate_median_m"), "");
  EXPECT_THAT(results_csv(read_results(runs_, context_.runs)),
              HasSubstr(",4,\"bad, \"\"very\"\" bad\","));
}

TEST_F(Results, ShareTheRunThatOdometryAloneIs) {
  perform(runs_[8], context_, {}, 0);
  EXPECT_THAT(read_results(runs_, context_.runs), SizeIs(4));
}

TEST_F(Results, AreAveragedOverTheSeeds) {
  perform(runs_[0], context_, {}, 0);
  perform(runs_[1], context_, {}, 0);
  std::istringstream lines(error_lines(read_results(runs_, context_.runs)));
  std::string header;
  std::string line;
  std::string rest;
  std::getline(lines, header);
  std::getline(lines, line);
  EXPECT_THAT(line, HasSubstr("flight default ideal"));
  EXPECT_THAT(line, HasSubstr("0.250"));
  EXPECT_FALSE(std::getline(lines, rest));
}

}  // namespace
}  // namespace fleetloc
