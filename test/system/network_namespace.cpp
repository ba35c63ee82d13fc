#include "test/system/network_namespace.hpp"

#include <sstream>
#include <stdexcept>
#include <system_error>
#include <thread>

#include <fcntl.h>
#include <sched.h>
#include <unistd.h>

#include "test/system/child_program.hpp"

namespace fleetloc {
namespace {

constexpr const char* kIp = "/sbin/ip";
constexpr const char* kOwn = "/proc/thread-self/ns/net";

[[noreturn]] void fail(const char* what) {
  throw std::system_error(errno, std::generic_category(), what);
}

int opened(const char* path) {
  const int descriptor = open(path, O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) fail(path);
  return descriptor;
}

// By a thread that ends afterwards: the others stay where they are. Negative: errno.
int new_namespace() {
  int descriptor = -1;
  std::jthread([&] {
    descriptor = unshare(CLONE_NEWNET) == 0 ? open(kOwn, O_RDONLY | O_CLOEXEC) : -errno;
  }).join();
  return descriptor;
}

int made_namespace() {
  const int descriptor = new_namespace();
  if (descriptor >= 0) return descriptor;
  throw std::system_error(-descriptor, std::generic_category(), "a network namespace");
}

}  // namespace

OwnedDescriptor::~OwnedDescriptor() {
  if (number_ >= 0) close(number_);
}

std::optional<std::string> NetworkNamespace::why_impossible() {
  if (access(kIp, X_OK) != 0) return std::string("there is no ") + kIp;
  const OwnedDescriptor tried(new_namespace());
  if (tried.number() >= 0) return std::nullopt;
  return "no network namespace can be made: " + std::generic_category().message(-tried.number());
}

NetworkNamespace::NetworkNamespace() : namespace_(made_namespace()) {
  ip("link set lo up");
}

NetworkNamespace::Scope::Scope(const NetworkNamespace& inside) : before_(opened(kOwn)) {
  if (setns(inside.namespace_.number(), CLONE_NEWNET) != 0) fail("setns");
}

NetworkNamespace::Scope::~Scope() {
  setns(before_.number(), CLONE_NEWNET);
}

void NetworkNamespace::ip(const std::string& words) const {
  const Scope inside(*this);
  std::vector<std::string> arguments;
  std::istringstream stream(words);
  for (std::string word; stream >> word;) arguments.push_back(word);
  const Outcome outcome = run(kIp, arguments);
  if (outcome.exit_code != 0) throw std::runtime_error("ip " + words + ": " + outcome.errors);
}

std::string NetworkNamespace::path() const {
  return "/proc/" + std::to_string(getpid()) + "/fd/" + std::to_string(namespace_.number());
}

SwitchedNetwork::SwitchedNetwork(bool carries_multicast) : carries_multicast_(carries_multicast) {
  switch_.ip("link add switch type bridge mcast_snooping 0");
  switch_.ip("link set switch up");
}

void SwitchedNetwork::plug_in(const NetworkNamespace& computer, const std::string& address) {
  const std::string port = "port" + std::to_string(++ports_);
  computer.ip("link add eth0 type veth peer name " + port + " netns " + switch_.path());
  switch_.ip("link set " + port + " master switch up");
  if (!carries_multicast_) switch_.ip("link set " + port + " type bridge_slave mcast_flood off");
  computer.ip("address add " + address + "/24 dev eth0");
  computer.ip("link set eth0 up");
  computer.ip("route add default dev eth0");  // also that of multicasts
}

void SwitchedNetwork::pull_out(const NetworkNamespace& computer) {
  computer.ip("link delete eth0");
}

}  // namespace fleetloc
