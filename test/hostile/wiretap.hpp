#pragma once

#include <array>
#include <cerrno>
#include <cstdint>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <arpa/inet.h>
#include <linux/filter.h>
#include <linux/if_ether.h>
#include <linux/if_packet.h>
#include <net/if.h>
#include <netinet/in.h>
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

  explicit Wiretap(std::uint32_t domain) {
    hear_only(7400 + 250 * domain);
    // The default has room for 93 announcements, of which a participant sends 32 at once.
    constexpr int kBytes = 16 << 20;
    if (setsockopt(socket_, SOL_SOCKET, SO_RCVBUFFORCE, &kBytes, sizeof kBytes) != 0) {
      throw std::system_error(errno, std::generic_category(), "SO_RCVBUFFORCE");
    }
    sockaddr_ll loopback{};
    loopback.sll_family = AF_PACKET;
    loopback.sll_protocol = htons(ETH_P_IP);  // from here on
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
  static int packet_socket() { return socket(AF_PACKET, SOCK_DGRAM | SOCK_CLOEXEC, 0); }

  /// UDP to a domain's ports: what other tests send meanwhile would fill the socket.
  void hear_only(std::uint32_t first_port) const {
    constexpr std::uint32_t kPorts = 250;
    constexpr std::uint32_t kProtocolAt = 9;
    constexpr std::uint32_t kPortAt = 2;  // behind the header of IP
    std::array<sock_filter, 8> program{{
        {BPF_LD | BPF_B | BPF_ABS, 0, 0, kProtocolAt},
        {BPF_JMP | BPF_JEQ | BPF_K, 0, 5, IPPROTO_UDP},
        {BPF_LDX | BPF_B | BPF_MSH, 0, 0, 0},  // the length of the header of IP
        {BPF_LD | BPF_H | BPF_IND, 0, 0, kPortAt},
        {BPF_JMP | BPF_JGE | BPF_K, 0, 2, first_port},
        {BPF_JMP | BPF_JGE | BPF_K, 1, 0, first_port + kPorts},
        {BPF_RET | BPF_K, 0, 0, 0xffff},
        {BPF_RET | BPF_K, 0, 0, 0},
    }};
    const sock_fprog filter{.len = program.size(), .filter = program.data()};
    if (setsockopt(socket_, SOL_SOCKET, SO_ATTACH_FILTER, &filter, sizeof filter) != 0) {
      throw std::system_error(errno, std::generic_category(), "SO_ATTACH_FILTER");
    }
  }

  /// What is in a packet of IP.
  static RtpsBytes datagram_in(RtpsBytes packet) {
    constexpr std::size_t kUdpHeader = 8;
    const std::size_t ip_header = packet.empty() ? 0 : std::size_t{4} * (packet[0] & 0x0fU);
    if (packet.size() < ip_header + kUdpHeader) return {};
    return packet.subspan(ip_header + kUdpHeader);
  }

  int socket_ = packet_socket();
};

}  // namespace fleetloc
