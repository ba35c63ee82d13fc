#include "test/system/poor_line.hpp"

#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <thread>

#include <unistd.h>

#include "test/system/recorded_flight.hpp"

namespace fleetloc {
namespace {

using Words = PoorLine::Words;

constexpr const char* kNft = "/usr/sbin/nft";
constexpr const char* kTc = "/sbin/tc";

std::string must_run_in(const NetworkNamespace& computer,
                        const std::string& program,
                        const Words& words) {
  const auto inside = computer.enter();
  const Outcome outcome = run(program, words);
  if (outcome.exit_code != 0) throw std::runtime_error(program + ": " + outcome.errors);
  return outcome.output;
}

/// Received and sent, of the computer that this thread is on.
std::array<double, 2> interface_bytes() {
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

void wait_for_sockets() {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (std::ranges::count(content_of("/proc/thread-self/net/udp"), '\n') <= 2) {  // a heading
    if (std::chrono::steady_clock::now() > deadline) {
      throw std::runtime_error("the robot opens no socket");
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

// [bytes], of "... { packets 12 bytes 3456 }"
double counter(const NetworkNamespace& computer, const std::string& name) {
  const std::string text = must_run_in(computer, kNft, {"list counter ip line " + name});
  const std::string word = " bytes ";
  return std::stod(text.substr(text.find(word) + word.size()));
}

}  // namespace

std::optional<std::string> PoorLine::why_impossible() {
  if (const auto reason = NetworkNamespace::why_impossible()) return reason;
  if (const auto reason = TunRelay::why_impossible()) return reason;
  for (const char* program : {kNft, kTc}) {
    if (access(program, X_OK) != 0) return std::string("there is no ") + program;
  }
  return std::nullopt;
}

PoorLine::PoorLine(const Config& config)
    : config_(config), relay_(robots_, localizers_, config.delay) {
  impair(robots_, TunRelay::kAddressB);
  impair(localizers_, TunRelay::kAddressA);
  must_run_in(robots_, kNft, {"add rule ip line closed counter name dropped drop"});
}

std::unique_ptr<ChildProgram> PoorLine::start(const NetworkNamespace& computer,
                                              const char* program,
                                              const Words& words) {
  const auto inside = computer.enter();
  return std::make_unique<ChildProgram>(program, words);
}

// Loss is at the receiver's: what is dropped at the sender's is told to the sending program.
void PoorLine::impair(const NetworkNamespace& computer, const char* other) const {
  must_run_in(computer,
              kNft,
              {"add table ip line; "
               "add counter ip line offered; "
               "add counter ip line dropped; "
               "add chain ip line out { type filter hook output priority 0; }; "
               "add rule ip line out oifname wan0 counter name offered; "
               "add chain ip line in { type filter hook prerouting priority -300; }; "
               "add chain ip line closed; "
               "add chain ip line loss; "
               "add rule ip line in iifname wan0 ip saddr " +
               std::string(other) + " jump closed; add rule ip line in iifname wan0 ip saddr " +
               std::string(other) + " jump loss"});
  if (config_.bytes_per_s == 0) return;
  const std::string rate = std::to_string(8 * config_.bytes_per_s) + "bit";
  must_run_in(computer,
              kTc,
              {"qdisc",
               "add",
               "dev",
               "wan0",
               "root",
               "tbf",
               "rate",
               rate,
               "burst",
               "3000",
               "latency",
               "2s"});
}

void PoorLine::begin_to_lose() const {
  const std::string percent = std::to_string(config_.loss_percent);
  for (const auto* computer : {&robots_, &localizers_}) {
    must_run_in(*computer,
                kNft,
                {"add rule ip line loss numgen random mod 100 < " + percent +
                 " counter name dropped drop"});
  }
}

void PoorLine::let_robots_receive() const {
  {
    const auto inside = robots_.enter();
    wait_for_sockets();
  }
  must_run_in(robots_, kNft, {"flush chain ip line closed"});
}

PoorLine::Counters PoorLine::counters() const {
  Counters counters;
  {
    const auto inside = robots_.enter();
    const auto [received, sent] = interface_bytes();
    counters.received = received;
    counters.sent = sent;
  }
  counters.offered = counter(robots_, "offered");
  counters.dropped = counter(robots_, "dropped");
  return counters;
}

}  // namespace fleetloc
