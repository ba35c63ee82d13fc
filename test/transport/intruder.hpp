#pragma once

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <system_error>
#include <vector>

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include "test/transport/rtps_messages.hpp"

namespace fleetloc {

/// Sends to all ports that participants of a domain listen on, and hears what they tell everyone.
class Intruder {
 public:
  static constexpr std::uint32_t kIds = 32;  // of all participants of this process

  /// @param unused_id  of a participant; the others look for it
  Intruder(std::uint32_t domain, std::uint32_t unused_id) : domain_(domain) {
    begin(address_of(unused_id, 0));
  }

  /// As if from another computer, which hears nothing.
  /// @param host  of loopback, 127.0.0.`host`
  static Intruder elsewhere(std::uint32_t domain, std::uint8_t host) {
    return Intruder(domain, host, 0);
  }
  ~Intruder() { close(socket_); }
  Intruder(const Intruder&) = delete;
  Intruder& operator=(const Intruder&) = delete;

  [[nodiscard]] Bytes hear() const {
    Bytes datagram(65536);
    const ssize_t size = recv(socket_, datagram.data(), datagram.size(), 0);
    datagram.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
    return datagram;
  }

  void send(const Bytes& datagram) const {
    for (std::uint32_t id = 0; id < kIds; ++id) {
      for (const std::uint32_t kind : {0U, 1U}) send_to(address_of(id, kind), datagram);
    }
  }

  /// Those where somebody listens, of discovery and of samples in turn.
  [[nodiscard]] std::vector<std::uint16_t> ports_in_use() const {
    std::vector<std::uint16_t> ports;
    for (std::uint32_t id = 0; id < kIds; ++id) {
      for (const std::uint32_t kind : {0U, 1U}) {
        const sockaddr_in address = address_of(id, kind);
        const int probe = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
        const auto* there = reinterpret_cast<const sockaddr*>(&address);
        if (bind(probe, there, sizeof address) != 0) ports.push_back(ntohs(address.sin_port));
        close(probe);
      }
    }
    return ports;
  }
  void send_to_port(std::uint16_t port, const Bytes& datagram) const {
    sockaddr_in to = address_of(0, 0);
    to.sin_port = htons(port);
    send_to(to, datagram);
  }

 private:
  Intruder(std::uint32_t domain, std::uint8_t host, int /*is_elsewhere*/) : domain_(domain) {
    sockaddr_in own{};
    own.sin_family = AF_INET;
    own.sin_addr.s_addr = htonl(0x7f000000U + host);
    begin(own);
  }

  void begin(const sockaddr_in& own) const {
    if (bind(socket_, reinterpret_cast<const sockaddr*>(&own), sizeof own) != 0) {
      throw std::system_error(errno, std::generic_category(), "bind");
    }
  }

  void send_to(const sockaddr_in& to, const Bytes& datagram) const {
    sendto(socket_,
           datagram.data(),
           datagram.size(),
           0,
           reinterpret_cast<const sockaddr*>(&to),
           sizeof to);
  }

  // DDS Interoperability Wire Protocol, 9.6.1.1.
  [[nodiscard]] sockaddr_in address_of(std::uint32_t id, std::uint32_t kind) const {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<std::uint16_t>(7410 + 250 * domain_ + 2 * id + kind));
    return address;
  }

  std::uint32_t domain_;
  int socket_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
};

/// An announcement as if it were somebody else's, in its header and in its parameters.
inline Bytes with_prefix(Bytes announced, const GuidPrefix& prefix) {
  const GuidPrefix own = sender_of(announced);
  auto found = announced.begin();
  while ((found = std::search(found, announced.end(), own.begin(), own.end())) != announced.end()) {
    found = std::copy(prefix.begin(), prefix.end(), found);
  }
  return announced;
}

}  // namespace fleetloc
