// What deploy/demo.sh says to its command line, before it installs or builds anything.
#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/system/child_program.hpp"

namespace fleetloc {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using Words = std::vector<std::string>;

constexpr const char* kScript = FLEETLOC_SOURCE_DIR "/deploy/demo.sh";

Outcome demo(Words words) {
  words.insert(words.begin(), kScript);
  return run("/bin/bash", words);
}

TEST(DemoScript, ExplainsItself) {
  const Outcome help = demo({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_EQ(help.errors, "");
  for (const char* word : {"DATASET", "--out", "--rate", "--initial-pose"}) {
    EXPECT_THAT(help.output, HasSubstr(word));
  }
}

TEST(DemoScript, RefusesWhatItDoesNotKnowInOneLine) {
  const ScratchFolder scratch;
  const std::string out = (scratch / "out").string();
  const std::string missing = (scratch / "missing").string();
  const std::vector<std::pair<Words, std::string>> wrong{
      {{"--fast"}, "--fast"},
      {{"--rate"}, "--rate needs a value"},
      {{"--rate", "quick"}, "'quick'"},
      {{"--rate", "0.0"}, "'0.0' is not a number above 0"},
      {{missing}, missing + "/mav0: no such folder"},
      {{"", "--rate", "1"}, "DATASET is empty"},
      {{"one", "two"}, "one dataset"},
      {{"--initial-pose", "0 0 0 0 0 0 1"}, "--initial-pose"}};
  for (const auto& [words, culprit] : wrong) {
    SCOPED_TRACE(testing::PrintToString(words));
    Words all{"--out", out};
    all.insert(all.end(), words.begin(), words.end());
    const Outcome outcome = demo(all);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_EQ(outcome.output, "");
    EXPECT_THAT(outcome.errors, AllOf(StartsWith("demo: "), HasSubstr(culprit)));
    EXPECT_EQ(std::ranges::count(outcome.errors, '\n'), 1) << outcome.errors;
  }
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST(DemoScript, RunsOncePerFolder) {
  const ScratchFolder scratch;
  const std::string out = (scratch / "out").string();
  std::filesystem::create_directories(out);
  const Outcome outcome =
      run("/usr/bin/flock", {out + "/.lock", "/bin/bash", kScript, "--out", out});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.errors, HasSubstr("another demo is running there"));
}

}  // namespace
}  // namespace fleetloc
