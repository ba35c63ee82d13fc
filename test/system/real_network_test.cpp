// Robot and localizer as programs on two computers, with a poor line between them that is the
// kernel's and not ours: its rate by a token bucket (tbf), its loss by a packet filter (nftables),
// its delay by a relay of packets. What its interfaces count is what the programs say.
#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <memory>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "test/system/driven_world.hpp"
#include "test/system/network_namespace.hpp"
#include "test/system/recorded_flight.hpp"
#include "test/system/run_watch.hpp"
#include "test/system/tun_relay.hpp"

namespace fleetloc {
namespace {

using Words = std::vector<std::string>;

constexpr const char* kNft = "/usr/sbin/nft";
constexpr const char* kTc = "/sbin/tc";
constexpr double kAgreement = 0.05;

/// Either way.
struct Line {
  int loss_percent = 0;
  std::chrono::milliseconds delay{0};
  int bytes_per_s = 0;  ///< 0: unlimited
};

/// At the robot's end of the line [bytes of IP].
struct Counters {
  double offered = 0.0;   // to the interface
  double sent = 0.0;      // by it
  double received = 0.0;  // by it
  double dropped = 0.0;   // of them, on purpose
};

std::string must_run_in(const NetworkNamespace& computer, const std::string& program, Words words) {
  const auto inside = computer.enter();
  const Outcome outcome = run(program, words);
  if (outcome.exit_code != 0) throw std::runtime_error(program + ": " + outcome.errors);
  return outcome.output;
}

class RealNetwork : public testing::Test {
 protected:
  void SetUp() override {
    if (kSanitized) GTEST_SKIP() << "sanitizers are too slow for real time";
    if (const auto reason = NetworkNamespace::why_impossible()) GTEST_SKIP() << *reason;
    if (const auto reason = TunRelay::why_impossible()) GTEST_SKIP() << *reason;
    for (const char* program : {kNft, kTc}) {
      if (access(program, X_OK) != 0) GTEST_SKIP() << "there is no " << program;
    }
    world_ = DrivenWorld::kept();
  }

  // Loss is at the receiver's: what is dropped at the sender's is told to the sending program.
  static void impair(const NetworkNamespace& computer, const Line& line, const char* other) {
    must_run_in(computer,
                kNft,
                {"add table ip line; "
                 "add chain ip line out { type filter hook output priority 0; }; "
                 "add rule ip line out oifname wan0 counter; "
                 "add chain ip line in { type filter hook prerouting priority -300; }; "
                 "add chain ip line loss; "
                 "add rule ip line in iifname wan0 ip saddr " +
                 std::string(other) + " jump loss"});
    if (line.bytes_per_s == 0) return;
    must_run_in(computer,
                kTc,
                {"qdisc",
                 "add",
                 "dev",
                 "wan0",
                 "root",
                 "tbf",
                 "rate",
                 std::to_string(8 * line.bytes_per_s) + "bit",
                 "burst",
                 "3000",
                 "latency",
                 "2s"});
  }

  static void lose(const NetworkNamespace& computer, int percent) {
    must_run_in(computer,
                kNft,
                {"add rule ip line loss numgen random mod 100 < " + std::to_string(percent) +
                 " counter drop"});
  }

  /// Discovery takes up to a minute where much is lost; it is not what is tested here.
  void wait_for_answer() const {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(25);
    while (std::chrono::steady_clock::now() < deadline) {
      if (std::filesystem::exists(run_ / "answers.csv") && !answers_of(run_).empty()) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    ADD_FAILURE() << "there is no answer";
  }

  [[nodiscard]] Words robot() const {
    return {"--robot-id",
            "robot_1",
            "--dataset",
            world_.forward.folder.string(),
            "--tracks",
            "--duration",
            "30",
            "--qos",
            FLEETLOC_SOURCE_DIR "/qos_profiles/lan.xml",
            "--initial-pose",
            world_.forward.displaced_start_pose(),
            "--out",
            run_.string()};
  }

  /// 30 s of a drive.
  void drive(const Line& line) {
    const NetworkNamespace robot_computer;
    const NetworkNamespace cloud_computer;
    const TunRelay relay(robot_computer, cloud_computer, line.delay);
    impair(robot_computer, line, TunRelay::kAddressB);
    impair(cloud_computer, line, TunRelay::kAddressA);
    const auto started = [](const NetworkNamespace& computer, const char* program, Words words) {
      const auto inside = computer.enter();
      return std::make_unique<ChildProgram>(program, words);
    };
    const auto cloud_folder = out_ / "localizer_1";
    const auto localizer = started(cloud_computer,
                                   FLEETLOC_CLOUD,
                                   {"--name",
                                    "localizer_1",
                                    "--map",
                                    world_.map.string(),
                                    "--qos",
                                    FLEETLOC_SOURCE_DIR "/qos_profiles/lan.xml",
                                    "--out",
                                    cloud_folder.string()});
    wait_for(cloud_folder / "status.csv");
    counters_ = counted(robot_computer);
    const auto robot_program = started(robot_computer, FLEETLOC_ROBOT, robot());
    counters_.received = received_before_sockets(robot_computer);  // by nobody
    wait_for_answer();
    lose(robot_computer, line.loss_percent);
    lose(cloud_computer, line.loss_percent);
    const Outcome robot_end = robot_program->wait();
    ASSERT_EQ(robot_end.exit_code, 0) << robot_end.errors;
    settle(robot_computer);
    localizer->signal(SIGTERM);
    EXPECT_EQ(localizer->wait().exit_code, 0);
    summary_ = parsed_json(run_ / "summary.json");
  }

  static void wait_for(const std::filesystem::path& file) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (!std::filesystem::exists(file)) {
      if (std::chrono::steady_clock::now() > deadline) throw std::runtime_error("does not serve");
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }

  static double received_before_sockets(const NetworkNamespace& computer) {
    const auto inside = computer.enter();
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (std::chrono::steady_clock::now() < deadline) {
      const std::string sockets = content_of("/proc/thread-self/net/udp");
      const double received = interface_bytes()[0];
      if (std::ranges::count(sockets, '\n') > 2) return received;  // beside the heading
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    throw std::runtime_error("the robot opens no socket");
  }

  /// What the robot's end of the line has counted since it was started.
  void settle(const NetworkNamespace& computer) {
    const Counters before = counters_;
    counters_ = counted(computer);
    counters_.offered -= before.offered;
    counters_.sent -= before.sent;
    counters_.received -= before.received;
    counters_.dropped -= before.dropped;
  }

  /// Received and sent, of the computer that this thread is on.
  static std::array<double, 2> interface_bytes() {
    std::istringstream lines(content_of("/proc/thread-self/net/dev"));
    for (std::string line; std::getline(lines, line);) {
      const auto name = line.find("wan0:");
      if (name == std::string::npos) continue;
      std::istringstream fields(line.substr(name + 5));
      std::array<double, 9> numbers{};
      for (double& number : numbers) fields >> number;
      return {numbers[0], numbers[8]};
    }
    throw std::runtime_error("there is no wan0");
  }

  static Counters counted(const NetworkNamespace& computer) {
    Counters counters;
    {
      const auto inside = computer.enter();
      const auto [received, sent] = interface_bytes();
      counters.received = received;
      counters.sent = sent;
    }
    counters.offered = counter_in(must_run_in(computer, kNft, {"list chain ip line out"}));
    counters.dropped = counter_in(must_run_in(computer, kNft, {"list chain ip line loss"}));
    return counters;
  }

  // "counter packets 12 bytes 3456", if there is one
  static double counter_in(const std::string& text) {
    if (text.find("counter packets") == std::string::npos) return 0.0;
    const std::string word = " bytes ";
    return std::stod(text.substr(text.find(word, text.find("counter packets")) + word.size()));
  }

  void expect_agreement() const {
    const double up = summary_.at("uplink_wire_bytes");
    const double down = summary_.at("downlink_wire_bytes");
    const double duration_s = summary_.at("duration_s");
    const double arrived = counters_.received - counters_.dropped;
    std::cout << "up " << up / duration_s << " B/s by the program, "
              << counters_.offered / duration_s << " offered, " << counters_.sent / duration_s
              << " sent\ndown " << down / duration_s << " B/s by the program, "
              << arrived / duration_s << " arrived, " << counters_.dropped / duration_s
              << " dropped\nanswers " << summary_.at("answers_received") << ", coverage "
              << summary_.at("coverage") << '\n';
    EXPECT_NEAR(up, counters_.offered, kAgreement * counters_.offered);
    EXPECT_NEAR(down, arrived, kAgreement * arrived);
    EXPECT_LE(counters_.sent, 1.01 * counters_.offered);
  }

  DrivenWorld world_;
  ScratchFolder out_;
  std::filesystem::path run_ = out_ / "robot_1";
  Counters counters_;
  nlohmann::json summary_;
};

TEST_F(RealNetwork, CountsWhatTheProgramsCountOnACleanLine) {
  drive({});
  expect_agreement();
  EXPECT_NEAR(counters_.sent, counters_.offered, 0.01 * counters_.offered);
  EXPECT_GT(summary_.at("answers_applied"), 20);
}

TEST_F(RealNetwork, CountsWhatTheProgramsCountOnASlowLongAndLossyLine) {
  drive({.loss_percent = 10, .delay = std::chrono::milliseconds(500), .bytes_per_s = 4000});
  expect_agreement();
  EXPECT_GT(summary_.at("answers_applied"), 0);
}

TEST_F(RealNetwork, CountsWhatTheProgramsCountWhereHalfIsLost) {
  drive({.loss_percent = 50});
  expect_agreement();
  EXPECT_GT(counters_.dropped, 0.3 * counters_.received);
  EXPECT_GT(summary_.at("answers_applied"), 10);
}

}  // namespace
}  // namespace fleetloc
