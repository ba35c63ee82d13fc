// What the programs say to their command line, whatever is wrong with it.
#include <algorithm>
#include <fstream>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/system/child_program.hpp"
#include "test/system/small_inputs.hpp"

namespace fleetloc {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using Options = std::map<std::string, std::string>;
using Words = std::vector<std::string>;

constexpr int kCannotStart = 2;
constexpr const char* kLan = FLEETLOC_SOURCE_DIR "/qos_profiles/lan.xml";

std::vector<std::string> arguments(const Options& options) {
  std::vector<std::string> words;
  for (const auto& [name, value] : options) {
    words.push_back(name);
    words.push_back(value);
  }
  return words;
}

Options with(Options options, const std::string& name, const std::string& value) {
  options[name] = value;
  return options;
}

Options without(Options options, const std::string& name) {
  options.erase(name);
  return options;
}

/// One line on stderr, that of the program, names what is wrong; nothing else happens.
void expect_refused(const std::string& program,
                    const std::vector<std::string>& words,
                    const std::string& culprit) {
  SCOPED_TRACE(testing::PrintToString(words));
  const Outcome outcome = run(program, words);
  EXPECT_EQ(outcome.exit_code, kCannotStart);
  EXPECT_EQ(outcome.output, "");
  const std::string name = std::filesystem::path(program).filename();
  EXPECT_THAT(outcome.errors, AllOf(StartsWith(name + ": "), HasSubstr(culprit)));
  EXPECT_EQ(std::ranges::count(outcome.errors, '\n'), 1) << outcome.errors;
}

void expect_refused(const std::string& program,
                    const Options& options,
                    const std::string& culprit) {
  expect_refused(program, arguments(options), culprit);
}

void expect_start_pose_checked(const std::string& program, const Options& good) {
  for (const char* pose : {"", "1 2 3", "1 2 3 0 0 0 one", "1 2 3 0 0 0 0", "1 2 nan 0 0 0 1"}) {
    expect_refused(program, with(good, "--initial-pose", pose), std::string("'") + pose + "'");
  }
}

/// Files that are right, and files that are not.
class CommandLine : public testing::Test {
 protected:
  CommandLine() {
    write_dataset(scratch_ / "dataset");
    write_wall(scratch_ / "wall.ply");
    std::ofstream(scratch_ / "wrong.yaml") << "tracking:\n  no_such_key: 3\n";
    std::ofstream(scratch_ / "malformed.xml") << "<dds><profiles>";
    std::ofstream(scratch_ / "other.xml")
        << "<profiles><participant profile_name=\"toaster\"><rtps><name>toaster</name></rtps>"
           "</participant></profiles>";
    std::ofstream(scratch_ / "file") << "not a folder\n";
    std::ofstream(scratch_ / "truth.tum") << "1000.0 0 0 0 0 0 0 1\n1000.1 0 0 0 0 0 0 1\n";
  }

  void SetUp() override {
    const Outcome built =
        run(FLEETLOC_MAP, {"build", "--cloud", file("wall.ply"), "--out", file("map.pcd")});
    ASSERT_EQ(built.exit_code, 0) << built.errors;
  }

  [[nodiscard]] std::string file(const std::string& name) const {
    return (scratch_ / name).string();
  }

  /// What is wrong with QoS, domain and configuration is wrong for each program with DDS.
  void expect_network_checked(const std::string& program, const Options& good) const {
    for (const char* name : {"missing.xml", "malformed.xml"}) {
      expect_refused(program, with(good, "--qos", file(name)), file(name));
    }
    expect_refused(program, with(good, "--qos", file("other.xml")), "no participant has");
    expect_refused(program, with(good, "--domain", "101"), "101");
    expect_refused(program, with(good, "--domain", "-1"), "-1");
    expect_refused(program, with(good, "--link", file("missing.yaml")), file("missing.yaml"));
  }

  /// Each of `required` is missed by its name, and what is not an option is named.
  void expect_options_checked(const std::string& program,
                              const Options& good,
                              const std::vector<std::string>& required) const {
    expect_refused(program, with(good, "--no-such-option", "1"), "--no-such-option");
    for (const std::string& name : required) expect_refused(program, without(good, name), name);
    expect_refused(program,
                   with(good, "--config", file("wrong.yaml")),
                   file("wrong.yaml") + ":2: tracking.no_such_key");
    expect_refused(program, with(good, "--config", file("missing.yaml")), file("missing.yaml"));
  }

  const ScratchFolder scratch_;
};

TEST_F(CommandLine, TheMapToolWarnsOfPointsThatAreTooSparseForTheirNormals) {
  write_wall(scratch_ / "sparse.ply", 0.3);
  std::ofstream(scratch_ / "wide.yaml") << "map: {normal_radius_m: 0.9}\n";
  std::vector<std::string> words{
      "build", "--cloud", file("sparse.ply"), "--out", file("sparse.pcd")};
  const Outcome sparse = run(FLEETLOC_MAP, words);
  EXPECT_EQ(sparse.exit_code, 0);
  EXPECT_THAT(sparse.errors, HasSubstr("warning: "));
  EXPECT_THAT(sparse.errors, HasSubstr("map.normal_radius_m 0.15"));
  words.insert(words.end(), {"--config", file("wide.yaml")});
  const Outcome wide = run(FLEETLOC_MAP, words);
  EXPECT_EQ(wide.exit_code, 0) << wide.errors;
  EXPECT_THAT(wide.errors, Not(HasSubstr("warning")));
}

TEST_F(CommandLine, AsksForHelpAndVersionOfEveryProgram) {
  for (const char* program : {FLEETLOC_ROBOT,
                              FLEETLOC_CLOUD,
                              FLEETLOC_MAP,
                              FLEETLOC_MONITOR,
                              FLEETLOC_PLAY,
                              FLEETLOC_REPLAY,
                              FLEETLOC_EVAL,
                              FLEETLOC_SIM,
                              FLEETLOC_EXPERIMENT,
                              FLEETLOC_TOPIC}) {
    const std::string name = std::filesystem::path(program).filename();
    const Outcome help = run(program, {"--help"});
    EXPECT_EQ(help.exit_code, 0) << name;
    EXPECT_THAT(help.output, AllOf(HasSubstr("--config"), HasSubstr("--print-config")));
    EXPECT_EQ(help.errors, "");
    const Outcome version = run(program, {"--version"});
    EXPECT_EQ(version.exit_code, 0) << name;
    EXPECT_THAT(version.output, StartsWith(name + " "));
    const Outcome config = run(program, {"--print-config"});
    EXPECT_EQ(config.exit_code, 0) << name;
    EXPECT_THAT(config.output, HasSubstr("tracking:"));
  }
}

TEST_F(CommandLine, IsCheckedByTheMonitor) {
  expect_refused(FLEETLOC_MONITOR, Words{"--ground-truth", file("truth.tum")}, "--run");
  expect_refused(FLEETLOC_MONITOR, Words{"--map", file("map.pcd")}, "--http");
  expect_refused(FLEETLOC_MONITOR, Words{"--qos", file("malformed.xml")}, file("malformed.xml"));
  expect_refused(FLEETLOC_MONITOR, Words{"--domain", "101"}, "101");
  expect_refused(FLEETLOC_MONITOR, Words{"--run", file("a"), "--no-such-option"}, "--no-such");
  expect_refused(FLEETLOC_MONITOR,
                 Words{"--run", file("a"), "--ground-truth", file("missing.tum")},
                 file("missing.tum"));
  const std::string truth = file("truth.tum");
  expect_refused(FLEETLOC_MONITOR,
                 Words{"--run", file("a"), "--ground-truth", truth, truth},
                 "2 files for 1 runs");
  const Outcome once = run(FLEETLOC_MONITOR, {"--run", file("a"), "--once"});
  EXPECT_EQ(once.exit_code, 0) << once.errors;
  EXPECT_THAT(once.output, AllOf(StartsWith("robot "), HasSubstr("\na ")));
}

TEST_F(CommandLine, IsCheckedByTheRobot) {
  const Options good{{"--robot-id", "robot_1"},
                     {"--dataset", file("dataset")},
                     {"--qos", kLan},
                     {"--out", file("out")},
                     {"--domain", "100"}};
  expect_options_checked(FLEETLOC_ROBOT, good, {"--robot-id", "--dataset", "--qos"});
  expect_network_checked(FLEETLOC_ROBOT, good);
  expect_start_pose_checked(FLEETLOC_ROBOT, good);
  for (const char* sigma : {"", "0.5", "0.5 five", "0.5 0", "-1 5", "1 2 3"}) {
    expect_refused(
        FLEETLOC_ROBOT, with(good, "--initial-sigma", sigma), std::string("'") + sigma + "'");
  }
  for (const char* region : {"", "hall B", "1 2", "1 2 0"}) {
    expect_refused(
        FLEETLOC_ROBOT, with(good, "--initial-region", region), std::string("'") + region + "'");
  }
  for (const char* id : {"", "a b", "robot/1", "abcdefghijklmnopqrstuvwxyz0123456"}) {
    expect_refused(FLEETLOC_ROBOT, with(good, "--robot-id", id), std::string("'") + id + "'");
  }
  expect_refused(FLEETLOC_ROBOT, with(good, "--dataset", file("none")), file("none"));
  expect_refused(FLEETLOC_ROBOT, with(good, "--out", file("file") + "/out"), file("file") + "/out");
  expect_refused(FLEETLOC_ROBOT, with(good, "--rate", "-1"), "--rate");
  expect_refused(FLEETLOC_ROBOT, with(good, "--duration", "0"), "--duration");
  expect_refused(FLEETLOC_ROBOT, with(good, "--encoding", "morse"), "morse");
  expect_refused(FLEETLOC_ROBOT, with(good, "--sensors", file("missing.yaml")), "--sensors");
  expect_refused(FLEETLOC_ROBOT,
                 with(without(good, "--dataset"), "--sensors", file("missing.yaml")),
                 file("missing.yaml"));
}

TEST_F(CommandLine, IsCheckedByTheCloud) {
  const Options good{{"--name", "localizer_1"},
                     {"--map", file("map.pcd")},
                     {"--qos", kLan},
                     {"--out", file("out")},
                     {"--domain", "100"}};
  expect_options_checked(FLEETLOC_CLOUD, good, {"--name", "--map", "--qos"});
  expect_network_checked(FLEETLOC_CLOUD, good);
  expect_refused(FLEETLOC_CLOUD, with(good, "--name", "a b"), "'a b'");
  expect_refused(FLEETLOC_CLOUD, with(good, "--publish-map", "0"), "--publish-map");
  expect_refused(FLEETLOC_CLOUD, with(good, "--monitor-qos", file("none.xml")), file("none.xml"));
  expect_refused(FLEETLOC_CLOUD, with(good, "--map", file("none.pcd")), file("none.pcd"));
  expect_refused(FLEETLOC_CLOUD, with(good, "--map", file("wall.ply")), file("wall"));
  expect_refused(FLEETLOC_CLOUD, with(good, "--out", file("file") + "/out"), file("file") + "/out");
}

TEST_F(CommandLine, IsCheckedByTheReplay) {
  const Options good{{"--dataset", file("dataset")}, {"--out", file("out")}};
  expect_options_checked(FLEETLOC_REPLAY, good, {"--dataset", "--out"});
  expect_start_pose_checked(FLEETLOC_REPLAY, good);
  expect_refused(FLEETLOC_REPLAY, with(good, "--dataset", file("none")), file("none"));
  expect_refused(FLEETLOC_REPLAY, with(good, "--map", file("none.pcd")), file("none.pcd"));
  expect_refused(
      FLEETLOC_REPLAY, with(good, "--out", file("file") + "/out"), file("file") + "/out");
  expect_refused(FLEETLOC_REPLAY, with(good, "--link", file("none.yaml")), file("none.yaml"));
  expect_refused(FLEETLOC_REPLAY, with(good, "--loss", "1.5"), "--loss");
  expect_refused(FLEETLOC_REPLAY, with(good, "--loss", "nan"), "--loss");
  expect_refused(FLEETLOC_REPLAY, with(good, "--latency", "-1"), "--latency");
  expect_refused(FLEETLOC_REPLAY, with(good, "--latency", "1e10"), "--latency");
  expect_refused(FLEETLOC_REPLAY, with(good, "--bandwidth", "inf"), "--bandwidth");
  expect_refused(FLEETLOC_REPLAY, with(good, "--start", "1e10"), "--start");
  expect_refused(FLEETLOC_REPLAY, with(good, "--duration", "nan"), "--duration");
  expect_refused(FLEETLOC_REPLAY, with(good, "--seed", "-1"), "--seed");
  expect_refused(FLEETLOC_REPLAY, with(good, "--direction", "sideways"), "sideways");
  expect_refused(FLEETLOC_REPLAY, with(good, "--window", "1"), "--window");
}

TEST_F(CommandLine, IsCheckedByThePlayer) {
  const auto refused = [&](Words more, const std::string& culprit) {
    more.insert(more.begin(), file("dataset"));
    expect_refused(FLEETLOC_PLAY, more, culprit);
  };
  expect_refused(FLEETLOC_PLAY, Words{}, "dataset");
  expect_refused(FLEETLOC_PLAY, Words{file("none")}, file("none"));
  refused({"--no-such-option"}, "--no-such-option");
  refused({"--rate", "0"}, "--rate");
  refused({"--rate", "nan"}, "--rate");
  refused({"--start", "1e10"}, "--start");
  refused({"--domain", "101"}, "101");
  refused({"--sensors", file("missing.yaml")}, file("missing.yaml"));
  refused({"--faults", file("missing.yaml")}, file("missing.yaml"));
}

TEST_F(CommandLine, IsCheckedByTheMapTool) {
  const std::string cloud = file("wall.ply");
  const std::string out = file("new.pcd");
  const auto refused = [&](const std::vector<std::string>& words, const std::string& culprit) {
    expect_refused(FLEETLOC_MAP, words, culprit);
  };
  refused({}, "subcommand");
  refused({"fold"}, "fold");
  refused({"info"}, "map");
  refused({"info", file("none.pcd")}, file("none.pcd"));
  refused({"build", "--out", out}, "--cloud");
  refused({"build", "--cloud", cloud}, "--out");
  refused({"build", "--cloud", cloud, "--dataset", file("dataset"), "--out", out}, "--dataset");
  refused({"build", "--dataset", file("dataset"), "--out", out}, file("dataset") + "/mav0/lidar0");
  refused({"build", "--cloud", cloud, "--out", out, "--no-such-option"}, "--no-such-option");
  refused({"build", "--cloud", file("none.ply"), "--out", out}, file("none.ply"));
  refused({"build", "--cloud", cloud, "--out", file("new.txt")}, file("new.txt"));
  refused({"build", "--cloud", cloud, "--out", out, "--config", file("wrong.yaml")},
          file("wrong.yaml") + ":2: tracking.no_such_key");
}

TEST_F(CommandLine, IsCheckedByTheTopicTool) {
  const auto refused = [](const std::vector<std::string>& words, const std::string& culprit) {
    expect_refused(FLEETLOC_TOPIC, words, culprit);
  };
  refused({}, "subcommand");
  refused({"fold"}, "fold");
  refused({"list", "--duration", "0"}, "--duration");
  refused({"echo", "--count", "-1"}, "--count");
  refused({"list", "--domain", "101"}, "101");
  refused({"echo", "--qos", file("malformed.xml")}, file("malformed.xml"));
  refused({"echo", "--qos", file("other.xml")}, "no participant has");
  refused({"echo", "--qos", kLan, "--profile", "toaster"}, "toaster");
  refused({"echo", "--no-such-option"}, "--no-such-option");
}

TEST_F(CommandLine, IsCheckedByTheEvaluation) {
  const Options good{{"--ground-truth", file("truth.tum")}, {"--estimate", file("truth.tum")}};
  expect_options_checked(FLEETLOC_EVAL, good, {"--ground-truth", "--estimate"});
  expect_refused(FLEETLOC_EVAL, with(good, "--ground-truth", file("none")), file("none"));
  expect_refused(FLEETLOC_EVAL, with(good, "--estimate", file("none")), file("none"));
  expect_refused(FLEETLOC_EVAL, with(good, "--align", "loosely"), "loosely");
  expect_refused(
      FLEETLOC_EVAL, with(without(good, "--estimate"), "--run", file("none")), file("none"));
}

TEST_F(CommandLine, IsCheckedByTheReport) {
  const std::string truth = file("truth.tum");
  const auto refused = [](const std::vector<std::string>& words, const std::string& culprit) {
    expect_refused(FLEETLOC_EVAL, words, culprit);
  };
  std::filesystem::create_directories(scratch_ / "run");
  const std::string folder = file("run");
  refused({"--run", folder}, "--ground-truth");
  refused({"--report", "r.html"}, "--run");
  refused({"--run", folder, "--ground-truth", truth, truth}, "2 files for 1 runs");
  refused({"--run", folder, file("none"), "--report", "r.html"}, file("none"));
  refused({"--run", folder, "--report", "r.html", "--map", file("none.pcd")}, file("none.pcd"));
  refused({"--run", folder, "--report", "r.html", "--sessions", file("none.json")},
          file("none.json"));
  refused({"--run", folder, "--ground-truth", truth, "--map", file("map.pcd")}, "--report");
}

TEST_F(CommandLine, ReportsARunAndRepeatsItWithItsConfiguration) {
  const std::string first = file("first");
  const Outcome once = run(FLEETLOC_REPLAY, {"--dataset", file("dataset"), "--out", first});
  ASSERT_EQ(once.exit_code, 0) << once.errors;
  const std::string config = content_of(scratch_ / "first" / "config.yaml");
  EXPECT_THAT(config, AllOf(StartsWith("# fleetloc-replay "), HasSubstr(" --out " + first + "\n")));
  const Outcome again = run(
      FLEETLOC_REPLAY,
      {"--dataset", file("dataset"), "--out", file("again"), "--config", first + "/config.yaml"});
  EXPECT_EQ(again.exit_code, 0) << again.errors;

  const Outcome reported =
      run(FLEETLOC_EVAL, {"--run", first, file("again"), "--report", file("new") + "/report.html"});
  EXPECT_EQ(reported.exit_code, 0) << reported.errors;
  EXPECT_THAT(reported.output, StartsWith("== " + first));
  EXPECT_THAT(content_of(scratch_ / "new" / "report.html"),
              AllOf(HasSubstr("<h2>first</h2>"), HasSubstr("<h2>again</h2>")));
  const Outcome plotless =
      run("/usr/bin/env",
          {"PATH=" + file("dataset"), FLEETLOC_EVAL, "--run", first, "--report", file("r.html")});
  EXPECT_EQ(plotless.exit_code, 1);
  EXPECT_THAT(plotless.errors, HasSubstr("install the package gnuplot-nox"));
  std::filesystem::remove(scratch_ / "first" / "answers.csv");
  const Outcome broken = run(FLEETLOC_EVAL, {"--run", first, "--report", file("r.html")});
  EXPECT_EQ(broken.exit_code, 1);
  EXPECT_THAT(broken.errors, HasSubstr(first + "/answers.csv"));
}

}  // namespace
}  // namespace fleetloc
