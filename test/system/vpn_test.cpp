// A robot behind a router that translates addresses, and a localizer, over the network that
// deploy/vpn/fleet-vpn.sh makes for them: programs in network namespaces, in real time.
#include <chrono>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <sstream>
#include <stdexcept>
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

constexpr const char* kFilter = "/usr/sbin/nft";
constexpr const char* kPublicAddress = "10.2.0.2";

std::optional<std::string> why_no_vpn() {
  if (const auto reason = NetworkNamespace::why_impossible()) return reason;
  if (const auto reason = TunRelay::why_impossible()) return reason;
  for (const char* program :
       {"/usr/bin/wg", "/usr/bin/wg-quick", "/usr/bin/wireguard-go", kFilter}) {
    if (access(program, X_OK) != 0) return std::string("there is no ") + program;
  }
  return std::nullopt;
}

std::string must_run(const std::string& program, const Words& words) {
  const Outcome outcome = run(program, words);
  if (outcome.exit_code != 0) throw std::runtime_error(program + ": " + outcome.errors);
  return outcome.output;
}

/// A robot's network, a router, and the localizer's network beyond it.
class Internet {
 public:
  Internet() {
    robot_.ip("link add eth0 type veth peer name lan0 netns " + router_.path());
    localizer_.ip("link add eth0 type veth peer name wan0 netns " + router_.path());
    robot_.ip("address add 192.168.5.2/24 dev eth0");
    router_.ip("address add 192.168.5.1/24 dev lan0");
    router_.ip("address add 10.2.0.1/24 dev wan0");
    localizer_.ip(std::string("address add ") + kPublicAddress + "/24 dev eth0");
    for (const auto* end : {&robot_, &localizer_}) end->ip("link set eth0 up");
    router_.ip("link set lan0 up");
    router_.ip("link set wan0 up");
    robot_.ip("route add default via 192.168.5.1");
    in(router_, "/bin/sh", {"-c", "echo 1 > /proc/sys/net/ipv4/ip_forward"});
    in(router_,
       kFilter,
       {"add table ip nat; add chain ip nat post { type nat hook postrouting priority 100; }; "
        "add rule ip nat post oifname wan0 masquerade"});
    in(robot_,
       kFilter,
       {"add table ip line; add counter ip line tunnel; add counter ip line inside; "
        "add counter ip line beside; "
        "add chain ip line out { type filter hook output priority 0; }; "
        "add rule ip line out oifname fleetvpn counter name inside; "
        "add rule ip line out oifname eth0 udp dport 51820 counter name tunnel accept; "
        "add rule ip line out oifname eth0 counter name beside"});
  }

  static std::string in(const NetworkNamespace& computer,
                        const std::string& program,
                        const Words& words) {
    const auto inside = computer.enter();
    return must_run(program, words);
  }

  struct Count {
    double packets = 0.0;
    double bytes = 0.0;
  };
  /// Of what has left the robot's computer.
  [[nodiscard]] Count sent(const std::string& counter) const {
    std::istringstream words(in(robot_, kFilter, {"list counter ip line " + counter}));
    Count count;
    for (std::string word; words >> word;) {
      if (word == "packets") words >> count.packets;
      if (word == "bytes") words >> count.bytes;
    }
    return count;
  }

  [[nodiscard]] const NetworkNamespace& robot() const { return robot_; }
  [[nodiscard]] const NetworkNamespace& router() const { return router_; }
  [[nodiscard]] const NetworkNamespace& localizer() const { return localizer_; }

 private:
  NetworkNamespace robot_;
  NetworkNamespace router_;
  NetworkNamespace localizer_;
};

class Vpn : public testing::Test {
 protected:
  void SetUp() override {
    if (kSanitized) GTEST_SKIP() << "sanitizers are too slow for real time";
    if (const auto reason = why_no_vpn()) GTEST_SKIP() << *reason;
    world_ = DrivenWorld::kept();
    internet_.emplace();
    make({"localizer", "localizer_1", kPublicAddress});
    make({"robot", "robot_1"});
    tunnels_.push_back(bring_up(internet_->localizer(), "localizer_1"));
    tunnels_.push_back(bring_up(internet_->robot(), "robot_1"));
  }

  void make(const Words& command) const {
    Words words{FLEETLOC_SOURCE_DIR "/deploy/vpn/fleet-vpn.sh",
                "--dir",
                (out_ / "vpn").string(),
                "--profile",
                FLEETLOC_SOURCE_DIR "/qos_profiles/lte-peers.xml"};
    words.insert(words.end(), command.begin(), command.end());
    must_run("/bin/sh", words);
  }

  /// With a folder of its own for what wireguard-go has one of for each interface's name. It ends
  /// with the program that is returned.
  [[nodiscard]] std::unique_ptr<ChildProgram> bring_up(const NetworkNamespace& computer,
                                                       const std::string& member) const {
    const std::string done = (out_ / (member + ".up")).string();
    auto program = start(computer,
                         "/usr/bin/unshare",
                         {"--mount",
                          "--propagation",
                          "private",
                          "/bin/sh",
                          "-ec",
                          "mkdir -p /run/wireguard; mount -t tmpfs none /run/wireguard; "
                          "wg-quick up \"$0\"; touch \"$1\"; exec sleep infinity",
                          file_of(member, "fleetvpn.conf"),
                          done});
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (!std::filesystem::exists(done)) {
      if (std::chrono::steady_clock::now() > deadline) {
        program->signal(SIGKILL);
        throw std::runtime_error("wg-quick: " + program->wait().errors);
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return program;
  }

  [[nodiscard]] std::string file_of(const std::string& member, const std::string& file) const {
    return (out_ / "vpn" / member / file).string();
  }

  static std::unique_ptr<ChildProgram> start(const NetworkNamespace& computer,
                                             const char* program,
                                             const Words& words) {
    const auto inside = computer.enter();
    return std::make_unique<ChildProgram>(program, words);
  }

  void start_localizer() {
    localizer_ = start(internet_->localizer(),
                       FLEETLOC_CLOUD,
                       {"--name",
                        "localizer_1",
                        "--map",
                        world_.map.string(),
                        "--qos",
                        file_of("localizer_1", "qos.xml"),
                        "--out",
                        (out_ / "localizer_1").string()});
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (!std::filesystem::exists(out_ / "localizer_1" / "status.csv")) {
      if (std::chrono::steady_clock::now() > deadline) throw std::runtime_error("does not serve");
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }

  [[nodiscard]] Words robot(const std::string& name, const std::string& profiles) const {
    return {"--robot-id",
            name,
            "--dataset",
            world_.forward.folder.string(),
            "--tracks",
            "--duration",
            "30",
            "--qos",
            profiles,
            "--initial-pose",
            world_.forward.displaced_start_pose(),
            "--out",
            (out_ / name).string()};
  }

  void end_localizer() {
    localizer_->signal(SIGTERM);
    const Outcome end = localizer_->wait();
    EXPECT_EQ(end.exit_code, 0) << end.errors;
  }

  ScratchFolder out_;
  DrivenWorld world_;
  std::optional<Internet> internet_;
  std::vector<std::unique_ptr<ChildProgram>> tunnels_;
  std::unique_ptr<ChildProgram> localizer_;
};

TEST_F(Vpn, CarriesARobotBehindARouterAndNothingLeavesBesideIt) {
  start_localizer();
  const auto program =
      start(internet_->robot(), FLEETLOC_ROBOT, robot("robot_1", file_of("robot_1", "qos.xml")));
  const Outcome end = program->wait();
  ASSERT_EQ(end.exit_code, 0) << end.errors;
  end_localizer();
  const auto errors = run_errors(out_ / "robot_1", world_.forward);
  const auto tunnel = internet_->sent("tunnel");
  const auto inside = internet_->sent("inside");
  std::cout << "answers " << answers_of(out_ / "robot_1").size() << ", ATE "
            << errors.at("ate").dump() << "\nup " << inside.bytes / 30.0 << " B/s in "
            << inside.packets << " datagrams, in the tunnel " << tunnel.bytes / 30.0 << " B/s in "
            << tunnel.packets << ": " << (tunnel.bytes - inside.bytes) / inside.packets
            << " bytes more each\n";
  EXPECT_GT(answers_of(out_ / "robot_1").size(), 20U);
  EXPECT_LT(errors.at("ate").at("median"), 0.15);
  EXPECT_EQ(errors.at("confidence").at("confidently_wrong"), 0);
  EXPECT_GT(inside.bytes, 10'000.0);
  EXPECT_EQ(internet_->sent("beside").packets, 0.0) << "of the fleet's data, in the clear";
}

// A localizer has a socket in the fleet's network only, so that who is not in it does not exist.
TEST_F(Vpn, IsWhereALocalizerHearsOnly) {
  start_localizer();
  std::string sockets =
      Internet::in(internet_->localizer(), "/bin/sh", {"-c", "ss --udp --listening --numeric"});
  std::cout << sockets;
  EXPECT_NE(sockets.find("10.86.0.1:74"), std::string::npos) << "of DDS";
  EXPECT_EQ(sockets.find("0.0.0.0:74"), std::string::npos);
  EXPECT_EQ(sockets.find(std::string(kPublicAddress) + ":74"), std::string::npos);
  end_localizer();
}

}  // namespace
}  // namespace fleetloc
