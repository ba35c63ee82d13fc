#pragma once

#include <array>
#include <cstdint>
#include <stdexcept>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

namespace fleetloc {

/// A UDP socket of this process on the last free port of a DDS domain, to which more was sent than
/// its receive buffer has room for: the kernel has dropped datagrams.
class FullSocket {
 public:
  static constexpr int kBuffer = 8192;  ///< [bytes]

  explicit FullSocket(std::uint32_t domain) {
    setsockopt(number_, SOL_SOCKET, SO_RCVBUF, &kBuffer, sizeof kBuffer);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const auto* its = reinterpret_cast<const sockaddr*>(&address);
    const std::uint32_t first_port = 7400 + 250 * domain;
    bool is_bound = false;
    for (std::uint32_t port = first_port + 249; port >= first_port && !is_bound; --port) {
      address.sin_port = htons(static_cast<std::uint16_t>(port));
      is_bound = bind(number_, its, sizeof address) == 0;
    }
    if (!is_bound) throw std::runtime_error("no port of the domain is free");
    const std::array<char, 1000> datagram{};
    for (int i = 0; i < 100; ++i) {
      sendto(number_, datagram.data(), datagram.size(), 0, its, sizeof address);
    }
  }
  ~FullSocket() { close(number_); }
  FullSocket(const FullSocket&) = delete;
  FullSocket& operator=(const FullSocket&) = delete;

 private:
  int number_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
};

}  // namespace fleetloc
