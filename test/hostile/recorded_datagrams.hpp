#pragma once

#include <cerrno>
#include <cstdint>
#include <system_error>
#include <vector>

#include <arpa/inet.h>
#include <linux/if_ether.h>
#include <net/if.h>
#include <netinet/ip.h>
#include <netinet/udp.h>
#include <netpacket/packet.h>
#include <sys/socket.h>

#include "shared/link/channel.hpp"
#include "test/system/network_namespace.hpp"

namespace fleetloc {

/// Hears all datagrams on loopback of the network namespace that this thread is in.
class RecordedDatagrams {
 public:
  struct Datagram {
    std::uint16_t port = 0;  // that it was sent to
    Bytes payload;
  };

  RecordedDatagrams() {
    sockaddr_ll loopback{};
    loopback.sll_family = AF_PACKET;
    loopback.sll_protocol = htons(ETH_P_IP);
    loopback.sll_ifindex = static_cast<int>(if_nametoindex("lo"));
    if (bind(socket_.number(), reinterpret_cast<const sockaddr*>(&loopback), sizeof loopback) !=
        0) {
      throw std::system_error(errno, std::generic_category(), "bind to packets of lo");
    }
  }

  /// What has come since the last call.
  std::vector<Datagram> take() {
    std::vector<Datagram> taken;
    Bytes packet(65536);
    sockaddr_ll from{};
    socklen_t size = sizeof from;
    for (;;) {
      const ssize_t length = recvfrom(socket_.number(),
                                      packet.data(),
                                      packet.size(),
                                      MSG_DONTWAIT,
                                      reinterpret_cast<sockaddr*>(&from),
                                      &size);
      if (length < 0) return taken;
      if (from.sll_pkttype == PACKET_OUTGOING) continue;  // each comes twice
      const auto header = static_cast<std::size_t>(packet[0] & 0x0fU) * 4;
      if (packet[9] != IPPROTO_UDP || static_cast<std::size_t>(length) < header + kUdpHeader)
        continue;
      const auto port = static_cast<std::uint16_t>(packet[header + 2] << 8U | packet[header + 3]);
      const auto begin = packet.begin() + static_cast<std::ptrdiff_t>(header + kUdpHeader);
      taken.push_back({.port = port, .payload = {begin, packet.begin() + length}});
    }
  }

 private:
  static constexpr std::size_t kUdpHeader = 8;

  OwnedDescriptor socket_{socket(AF_PACKET, SOCK_DGRAM | SOCK_CLOEXEC, htons(ETH_P_IP))};
};

}  // namespace fleetloc
