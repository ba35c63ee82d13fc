#pragma once

#include <cerrno>
#include <cstdint>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <arpa/inet.h>
#include <linux/if_ether.h>
#include <linux/if_packet.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

#include "test/transport/rtps_messages.hpp"

namespace fleetloc {

/// Hears what participants of a domain on loopback are sent, as somebody on their network does.
class Wiretap {
 public:
  /// It needs a packet socket, and that root.
  static std::optional<std::string> why_impossible() {
    const int probe = packet_socket();
    if (probe < 0) return "no packet socket: needs root";
    close(probe);
    return std::nullopt;
  }

  explicit Wiretap(std::uint32_t domain) : first_port_(7400 + 250 * domain) {
    sockaddr_ll loopback{};
    loopback.sll_family = AF_PACKET;
    loopback.sll_protocol = htons(ETH_P_IP);
    loopback.sll_ifindex = static_cast<int>(if_nametoindex("lo"));
    if (bind(socket_, reinterpret_cast<const sockaddr*>(&loopback), sizeof loopback) != 0) {
      throw std::system_error(errno, std::generic_category(), "bind");
    }
  }
  ~Wiretap() { close(socket_); }
  Wiretap(const Wiretap&) = delete;
  Wiretap& operator=(const Wiretap&) = delete;

  /// In the name of a participant, since the last call.
  [[nodiscard]] std::vector<Bytes> heard_from(const GuidPrefix& sender) const {
    std::vector<Bytes> heard;
    Bytes packet(65536);
    for (;;) {
      const ssize_t size = recv(socket_, packet.data(), packet.size(), MSG_DONTWAIT);
      if (size < 0) return heard;
      const auto datagram = datagram_in({packet.data(), static_cast<std::size_t>(size)});
      if (datagram.size() < kRtpsHeaderBytes || sender_of(datagram) != sender) continue;
      heard.emplace_back(datagram.begin(), datagram.end());
    }
  }

 private:
  static int packet_socket() {
    return socket(AF_PACKET, SOCK_DGRAM | SOCK_CLOEXEC, htons(ETH_P_IP));
  }

  /// Nothing if it is no UDP to one of the domain's ports.
  [[nodiscard]] RtpsBytes datagram_in(RtpsBytes packet) const {
    constexpr std::size_t kUdpHeader = 8;
    constexpr std::uint8_t kUdp = 17;
    constexpr std::size_t kProtocolAt = 9;
    constexpr std::uint32_t kPorts = 250;
    const std::size_t ip_header = packet.empty() ? 0 : std::size_t{4} * (packet[0] & 0x0fU);
    if (packet.size() < ip_header + kUdpHeader || packet[kProtocolAt] != kUdp) return {};
    const RtpsBytes udp = packet.subspan(ip_header);
    const std::uint32_t port = static_cast<std::uint32_t>(udp[2]) << 8U | udp[3];
    if (port < first_port_ || port >= first_port_ + kPorts) return {};
    return udp.subspan(kUdpHeader);
  }

  std::uint32_t first_port_;
  int socket_ = packet_socket();
};

}  // namespace fleetloc
