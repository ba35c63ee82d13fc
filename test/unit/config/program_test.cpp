#include "shared/config/program.hpp"

#include <algorithm>
#include <fstream>
#include <stdexcept>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "deploy/config/default_config.hpp"
#include "shared/config/progress_line.hpp"
#include "test/test_folder.hpp"

namespace fleetloc {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

struct Outcome {
  int exit_code = 0;
  std::string output;
  std::string errors;
};

/// Runs a program with one required option, --map.
Outcome run(
    std::vector<const char*> arguments,
    const std::function<Program::Run()>& prepare = [] { return [] { return 0; }; }) {
  Program program("fleetloc-test", "Does nothing.", default_config("everything"));
  std::string map;
  program.options().add_option("--map", map, "a map")->required();
  arguments.insert(arguments.begin(), "fleetloc-test");
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  Outcome outcome;
  outcome.exit_code = program.run(static_cast<int>(arguments.size()), arguments.data(), prepare);
  outcome.output = ::testing::internal::GetCapturedStdout();
  outcome.errors = ::testing::internal::GetCapturedStderr();
  return outcome;
}

TEST(Program, ReturnsWhatTheRunReturns) {
  EXPECT_EQ(run({"--map", "a"}).exit_code, 0);
  EXPECT_EQ(run({"--map", "a"}, [] { return [] { return 1; }; }).exit_code, 1);
}

TEST(Program, RefusesAnUnknownOptionInOneLine) {
  const Outcome outcome = run({"--map", "a", "--mop", "b"});
  EXPECT_EQ(outcome.exit_code, kCannotStart);
  EXPECT_THAT(outcome.errors, AllOf(StartsWith("fleetloc-test: "), HasSubstr("--mop")));
  EXPECT_EQ(std::ranges::count(outcome.errors, '\n'), 1);
}

TEST(Program, NamesAnUnknownOptionEvenIfARequiredOneIsMissing) {
  const Outcome outcome = run({"--mop", "b"});
  EXPECT_EQ(outcome.exit_code, kCannotStart);
  EXPECT_THAT(outcome.errors, HasSubstr("unknown argument --mop"));
}

TEST(Program, RefusesToStartWithoutARequiredOption) {
  const Outcome outcome = run({});
  EXPECT_EQ(outcome.exit_code, kCannotStart);
  EXPECT_THAT(outcome.errors, HasSubstr("--map is required"));
}

TEST(Program, KeepsItsCommandLineAsOneLineOfComment) {
  Program program("fleetloc-test", "Does nothing.", default_config("everything"));
  std::vector<std::string> words;
  program.options().add_option("words", words);
  const std::vector<const char*> arguments{"fleetloc-test", "a", "1 2", "c\nd"};
  program.run(
      static_cast<int>(arguments.size()), arguments.data(), [] { return [] { return 0; }; });
  EXPECT_THAT(program.command_line(),
              AllOf(StartsWith("# fleetloc-test "), EndsWith(": a '1 2' c d\n")));
}

TEST(Program, SaysItsVersionAndConfigurationWithoutRequiredOptions) {
  EXPECT_THAT(run({"--version"}).output, StartsWith("fleetloc-test "));
  EXPECT_EQ(run({"--version"}).exit_code, kSuccess);
  EXPECT_THAT(run({"--print-config"}).output, HasSubstr("resolution_m: "));
  EXPECT_EQ(run({"--print-config"}).exit_code, kSuccess);
  EXPECT_THAT(run({"--help"}).output, HasSubstr("--print-config"));
}

TEST(Program, CannotStartIfPreparingThrows) {
  const Outcome outcome =
      run({"--map", "a"}, []() -> Program::Run { throw std::runtime_error("no such map"); });
  EXPECT_EQ(outcome.exit_code, kCannotStart);
  EXPECT_EQ(outcome.errors, "fleetloc-test: no such map\n");
}

TEST(Program, FailsIfRunningThrows) {
  const Outcome outcome = run(
      {"--map", "a"}, [] { return []() -> int { throw std::runtime_error("the disk is full"); }; });
  EXPECT_EQ(outcome.exit_code, kFailedAtRunTime);
  EXPECT_EQ(outcome.errors, "fleetloc-test: the disk is full\n");
}

TEST(Program, OverlaysTheConfigurationThatItPrints) {
  const std::string file = (test_folder() / "fleetloc_program_test.yaml").string();
  std::ofstream(file) << "map: {resolution_m: 0.25}\n";
  const Outcome outcome = run({"--print-config", "--config", file.c_str()});
  EXPECT_THAT(outcome.output, AllOf(HasSubstr("resolution_m: 0.25"), HasSubstr("min_neighbours")));
}

TEST(Program, NamesAKeyThatDoesNotExist) {
  const std::string file = (test_folder() / "fleetloc_program_test.yaml").string();
  std::ofstream(file) << "map:\n  resolution: 0.25\n";
  const Outcome outcome = run({"--print-config", "--config", file.c_str()});
  EXPECT_EQ(outcome.exit_code, kCannotStart);
  EXPECT_THAT(outcome.errors, HasSubstr(file + ":2: map.resolution: unknown key"));
}

TEST(ProgressText, SaysRateAndTimeLeft) {
  EXPECT_EQ(progress_text("normals", 100, 400, std::chrono::seconds(2)),
            "normals  100/400  25 %  50/s  6 s left");
}

}  // namespace
}  // namespace fleetloc
