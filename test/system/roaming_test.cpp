// Interfaces that disappear and return while robot and localizer run: programs in network
// namespaces, over DDS, in real time.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/system/driven_world.hpp"
#include "test/system/network_namespace.hpp"
#include "test/system/recorded_flight.hpp"
#include "test/system/run_watch.hpp"

namespace fleetloc {
namespace {

using std::chrono::seconds;
using ::testing::AnyOf;
using ::testing::Each;
using ::testing::Le;

using Words = std::vector<std::string>;

std::size_t occurrences(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

class Roaming : public testing::Test {
 protected:
  void SetUp() override {
    if (kSanitized) GTEST_SKIP() << "sanitizers are too slow for real time";
    if (const auto reason = NetworkNamespace::why_impossible()) GTEST_SKIP() << *reason;
    world_ = DrivenWorld::kept();
    name_hosts({});
  }

  void connect(bool carries_multicast) {
    switch_.emplace(carries_multicast);
    plug_in(robot_.emplace(), "10.77.0.1");
    plug_in(cloud_.emplace(), "10.77.0.2");
  }

  void plug_in(const NetworkNamespace& computer, const std::string& address) {
    switch_->plug_in(computer, address);
  }

  /// The names that programs know from now on.
  void name_hosts(const std::vector<std::pair<std::string, std::string>>& addresses) const {
    std::ofstream stream(out_ / "hosts");  // keeps its inode: it is mounted
    stream << "127.0.0.1 localhost\n";
    for (const auto& [name, address] : addresses) stream << address << ' ' << name << '\n';
  }

  /// A program on a computer, with its own /etc/hosts.
  [[nodiscard]] std::unique_ptr<ChildProgram> started(const NetworkNamespace& computer,
                                                      const Words& command) const {
    Words words{"--mount",
                "--propagation",
                "private",
                "/bin/sh",
                "-c",
                R"(mount --bind "$0" /etc/hosts && exec "$@")",
                (out_ / "hosts").string()};
    words.insert(words.end(), command.begin(), command.end());
    const auto inside = computer.enter();
    return std::make_unique<ChildProgram>("/usr/bin/unshare", words);
  }

  /// To load the map takes as long as it takes.
  void wait_until_it_serves() const {
    const auto deadline = std::chrono::steady_clock::now() + seconds(60);
    while (!std::filesystem::exists(out_ / "localizer_1" / "status.csv")) {
      if (std::chrono::steady_clock::now() > deadline)
        throw std::runtime_error("it does not serve");
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }

  void start(const std::string& qos, const Words& more = {}) {
    const std::string profiles = std::string(FLEETLOC_SOURCE_DIR "/qos_profiles/") + qos + ".xml";
    localizer_ = started(*cloud_,
                         {FLEETLOC_CLOUD,
                          "--name",
                          "localizer_1",
                          "--map",
                          world_.map.string(),
                          "--qos",
                          profiles,
                          "--out",
                          (out_ / "localizer_1").string()});
    wait_until_it_serves();
    Words robot{FLEETLOC_ROBOT,
                "--robot-id",
                "robot_1",
                "--dataset",
                world_.forward.folder.string(),
                "--tracks",
                "--qos",
                profiles,
                "--initial-pose",
                world_.forward.displaced_start_pose(),
                "--out",
                run_.string()};
    robot.insert(robot.end(), more.begin(), more.end());
    program_ = started(*robot_, robot);
  }

  /// Without its network for a while; it comes back at this address. The stamp of the robot's data
  /// when it did.
  Timestamp interrupt(const NetworkNamespace& computer, double at_s, const std::string& address) {
    constexpr double kAway = 5.0;
    wait_for_data(run_, std::chrono::duration<double>(at_s));
    SwitchedNetwork::pull_out(computer);
    wait_for_data(run_, std::chrono::duration<double>(at_s + kAway));
    plug_in(computer, address);
    return frames_of(run_).back().stamp;
  }

  /// What must be true at the end of any drive, whatever happened to the network.
  void expect_one_session_and_honest_poses(const std::vector<Timestamp>& returns) {
    const Outcome robot = program_->wait();
    EXPECT_EQ(robot.exit_code, 0) << robot.errors;
    localizer_->signal(SIGTERM);
    const Outcome localizer = localizer_->wait();
    EXPECT_EQ(localizer.exit_code, 0) << localizer.errors;
    std::cout << robot.output << localizer.output;
    const std::vector<double> silent_s = silences(returns);
    for (const double s : silent_s) {
      std::cout << "answered " << s << " s after the network's return\n";
    }
    EXPECT_THAT(silent_s, Each(Le(5.0)));
    EXPECT_EQ(occurrences(robot.output, "started as"), 1) << "the localizer was chosen again";
    const auto session = parsed_json(out_ / "localizer_1" / "sessions.json").at("robot_1");
    EXPECT_EQ(session.at("sessions"), 1);
    const auto errors = run_errors(run_, world_.forward);
    std::cout << "ATE " << errors.at("ate").dump() << '\n';
    EXPECT_EQ(errors.at("confidence").at("confidently_wrong"), 0);
    EXPECT_LT(errors.at("ate").at("median"), 0.15);
    const auto answers = answers_of(run_);
    const auto first = std::ranges::find_if(answers, &AnswerLine::applied);
    ASSERT_NE(first, answers.end());
    for (const FrameLine& frame : frames_of(run_)) {
      if (frame.stamp <= first->arrival) continue;
      EXPECT_THAT(frame.state, AnyOf("localized", "dead_reckoning"));
    }
  }

  /// From the network's return on [s of data], for each return.
  [[nodiscard]] std::vector<double> silences(const std::vector<Timestamp>& returns) const {
    const auto answers = answers_of(run_);
    std::vector<double> silences;
    for (const Timestamp back : returns) {
      const auto next = std::ranges::find_if(answers, [&](const AnswerLine& answer) {
        return answer.arrival > back && answer.applied;
      });
      silences.push_back(next == answers.end() ? 1e9 : to_seconds(next->arrival - back));
    }
    return silences;
  }

  DrivenWorld world_;
  ScratchFolder out_;
  std::filesystem::path run_ = out_ / "robot_1";
  std::optional<SwitchedNetwork> switch_;
  std::optional<NetworkNamespace> robot_, cloud_;
  std::unique_ptr<ChildProgram> localizer_, program_;
};

TEST_F(Roaming, GetsItsAnswersAgainWithItsSessionAndItsPose) {
  connect(true);
  start("lan", {"--duration", "75"});
  expect_one_session_and_honest_poses({interrupt(*robot_, 10, "10.77.0.1"),
                                       interrupt(*robot_, 25, "10.77.0.3"),
                                       interrupt(*cloud_, 40, "10.77.0.2"),
                                       interrupt(*cloud_, 55, "10.77.0.4")});
}

TEST_F(Roaming, FindsALocalizerByItsNameWhereverItIs) {
  connect(false);  // nor is the localizer's name known when the programs start
  start("lan-peers", {"--duration", "55"});
  wait_for_data(run_, seconds(5));
  EXPECT_TRUE(answers_of(run_).empty());
  name_hosts({{"localizer_1", "10.77.0.2"}});
  const Timestamp robot_back = interrupt(*robot_, 15, "10.77.0.3");
  wait_for_data(run_, seconds(28));
  name_hosts({{"localizer_1", "10.77.0.4"}});
  expect_one_session_and_honest_poses({robot_back, interrupt(*cloud_, 30, "10.77.0.4")});
}

TEST_F(Roaming, GoesOnThroughADiscoveryServerThatStartsLateAndIsRestarted) {
  const Words server{"/usr/bin/fast-discovery-server", "-i", "0", "-l", "0.0.0.0", "-p", "11811"};
  if (!std::filesystem::exists(server.front())) GTEST_SKIP() << "there is no " << server.front();
  connect(false);
  const NetworkNamespace discovery;
  plug_in(discovery, "10.77.0.9");
  start("lan-server", {"--duration", "70"});
  wait_for_data(run_, seconds(5));
  EXPECT_TRUE(answers_of(run_).empty());
  name_hosts({{"discovery", "10.77.0.9"}});
  auto running = started(discovery, server);
  const Timestamp robot_back = interrupt(*robot_, 18, "10.77.0.3");
  const Timestamp killed = wait_for_data(run_, seconds(27));
  running->signal(SIGKILL);
  running->wait();
  const Timestamp restarted = wait_for_data(run_, seconds(32));
  running = started(discovery, server);
  // It has forgotten the robot, which notices that.
  const Timestamp cloud_back = interrupt(*cloud_, 36, "10.77.0.4");
  expect_one_session_and_honest_poses({robot_back, cloud_back});
  const auto answers = answers_of(run_);
  EXPECT_GT(std::ranges::count_if(answers,
                                  [&](const AnswerLine& answer) {
                                    return killed < answer.arrival && answer.arrival < restarted;
                                  }),
            4)
      << "those who had met did not go on without the server";
}

}  // namespace
}  // namespace fleetloc
