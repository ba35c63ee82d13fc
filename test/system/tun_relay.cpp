#include "test/system/tun_relay.hpp"

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <deque>
#include <fstream>
#include <optional>
#include <stop_token>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <linux/if_tun.h>
#include <net/if.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace fleetloc {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kTun = "/dev/net/tun";
constexpr const char* kInterface = "wan0";
constexpr std::size_t kMaxPacket = 2000;

struct Packet {
  Clock::time_point due;
  std::vector<std::uint8_t> bytes;
};

// Bare IP packets, without Ethernet.
int opened_in(const NetworkNamespace& computer) {
  const auto inside = computer.enter();
  const int descriptor = open(kTun, O_RDWR | O_NONBLOCK | O_CLOEXEC);
  ifreq request{};
  request.ifr_flags = IFF_TUN | IFF_NO_PI;
  std::strncpy(request.ifr_name, kInterface, IFNAMSIZ - 1);
  if (descriptor < 0 || ioctl(descriptor, TUNSETIFF, &request) != 0) {
    throw std::system_error(errno, std::generic_category(), kTun);
  }
  return descriptor;
}

void set_up(const NetworkNamespace& computer, const std::string& own, const std::string& other) {
  {
    const auto inside = computer.enter();  // or it would send of its own accord
    std::ofstream("/proc/sys/net/ipv6/conf/all/disable_ipv6") << 1;
  }
  computer.ip("address add " + own + " peer " + other + " dev wan0");
  computer.ip("link set wan0 up mtu 1500 txqueuelen 1000 multicast on");
  computer.ip("route add default dev wan0");  // also that of multicasts
}

void take(int from, std::chrono::milliseconds delay, std::deque<Packet>& line) {
  std::array<std::uint8_t, kMaxPacket> buffer;
  for (;;) {
    const auto size = read(from, buffer.data(), buffer.size());
    if (size <= 0) return;
    line.push_back({Clock::now() + delay, {buffer.begin(), buffer.begin() + size}});
  }
}

void give(int to, std::deque<Packet>& line) {
  while (!line.empty() && line.front().due <= Clock::now()) {
    const auto& bytes = line.front().bytes;
    static_cast<void>(write(to, bytes.data(), bytes.size()));
    line.pop_front();
  }
}

void carry(const std::stop_token& stop, int a, int b, std::chrono::milliseconds delay) {
  constexpr int kLookMilliseconds = 2;
  std::deque<Packet> to_a, to_b;
  while (!stop.stop_requested()) {
    std::array<pollfd, 2> descriptors{{{a, POLLIN, 0}, {b, POLLIN, 0}}};
    poll(descriptors.data(), descriptors.size(), kLookMilliseconds);
    take(a, delay, to_b);
    take(b, delay, to_a);
    give(a, to_a);
    give(b, to_b);
  }
}

}  // namespace

std::optional<std::string> TunRelay::why_impossible() {
  const OwnedDescriptor tried(open(kTun, O_RDWR | O_CLOEXEC));
  if (tried.number() >= 0) return std::nullopt;
  return std::string(kTun) + ": " + std::generic_category().message(errno);
}

TunRelay::TunRelay(const NetworkNamespace& a,
                   const NetworkNamespace& b,
                   std::chrono::milliseconds delay)
    : a_(opened_in(a)), b_(opened_in(b)), delay_(delay) {
  set_up(a, kAddressA, kAddressB);
  set_up(b, kAddressB, kAddressA);
  thread_ = std::jthread(
      [this](const std::stop_token& stop) { carry(stop, a_.number(), b_.number(), delay_); });
}

}  // namespace fleetloc
