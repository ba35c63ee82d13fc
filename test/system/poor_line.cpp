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

double received_before_sockets() {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (std::chrono::steady_clock::now() < deadline) {
    const std::string sockets = content_of("/proc/thread-self/net/udp");
    const double received = interface_bytes()[0];
    if (std::ranges::count(sockets, '\n') > 2) return received;  // beside the heading
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  throw std::runtime_error("the robot opens no socket");
}

// "counter packets 12 bytes 3456", if there is one
double counter_in(const std::string& text) {
  if (text.find("counter packets") == std::string::npos) return 0.0;
  const std::string word = " bytes ";
  return std::stod(text.substr(text.find(word, text.find("counter packets")) + word.size()));
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
               "add chain ip line out { type filter hook output priority 0; }; "
               "add rule ip line out oifname wan0 counter; "
               "add chain ip line in { type filter hook prerouting priority -300; }; "
               "add chain ip line loss; "
               "add rule ip line in iifname wan0 ip saddr " +
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
                {"add rule ip line loss numgen random mod 100 < " + percent + " counter drop"});
  }
}

void PoorLine::ignore_received_before_sockets() {
  const auto inside = robots_.enter();
  before_.received = received_before_sockets();
}

PoorLine::Counters PoorLine::counters() const {
  Counters counters = counted();
  counters.offered -= before_.offered;
  counters.sent -= before_.sent;
  counters.received -= before_.received;
  counters.dropped -= before_.dropped;
  return counters;
}

PoorLine::Counters PoorLine::counted() const {
  Counters counters;
  {
    const auto inside = robots_.enter();
    const auto [received, sent] = interface_bytes();
    counters.received = received;
    counters.sent = sent;
  }
  counters.offered = counter_in(must_run_in(robots_, kNft, {"list chain ip line out"}));
  counters.dropped = counter_in(must_run_in(robots_, kNft, {"list chain ip line loss"}));
  return counters;
}

}  // namespace fleetloc
