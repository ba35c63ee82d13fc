#pragma once

#include <atomic>
#include <functional>
#include <memory>

#include <fastdds/rtps/common/Locator.h>

#include "shared/transport/delay_line.hpp"
#include "shared/transport/wire_link.hpp"

namespace eprosima::fastrtps::rtps {
class SenderResource;
}  // namespace eprosima::fastrtps::rtps

namespace fleetloc {

/// Sends datagrams whose destinations are chosen: held until the participant may be heard, counted,
/// then through the emulated link if there is one; at once, or later. From any thread, while the
/// sockets live.
class DatagramSender {
 public:
  using Clock = std::chrono::steady_clock;
  using Socket = eprosima::fastrtps::rtps::SenderResource;
  using Locator = eprosima::fastrtps::rtps::Locator_t;
  using Destinations = eprosima::fastdds::rtps::LocatorList;

  static constexpr std::chrono::milliseconds kPatience{100};  ///< with a socket, for what is late
  /// So that one burst does not take them all.
  static constexpr std::chrono::milliseconds kBetweenCopies{25};

  /// Both outlive it. With a whitelist Fast DDS has a socket for each of its interfaces.
  DatagramSender(WireLink& link, DelayLine& delay_line, bool has_whitelist)
      : link_(link), delay_line_(delay_line), has_whitelist_(has_whitelist) {}

  /// True once: of the first socket that anything is sent with.
  bool begins_with(Socket* socket);
  [[nodiscard]] bool is_first(const Socket* socket) const { return socket == first_socket_; }

  /// Fast DDS gives a datagram to all sockets of a UDP transport. Without a whitelist the first one
  /// sends it to every address (a multicast on loopback only), the others, one an interface, send
  /// multicasts only; with a whitelist every socket sends to every address.
  [[nodiscard]] bool reaches(const Socket* socket, const Locator& to) const;

  /// False if the socket has refused it.
  bool send(Socket* socket,
            RtpsBytes datagram,
            const Destinations& destinations,
            Clock::time_point timeout);

  /// For later, to one destination; copies the datagram, which Fast DDS lends for a call only.
  [[nodiscard]] std::function<void()> sending(Socket* socket,
                                              RtpsBytes datagram,
                                              const Locator& to);

  /// A number of them, one after the other.
  void send_copies(
      Socket* socket, RtpsBytes datagram, const Locator& to, int number, Clock::time_point now);

  /// The same again a little later.
  [[nodiscard]] std::function<void()> twice(std::function<void()> send);

 private:
  bool emulate(Socket* socket,
               RtpsBytes datagram,
               const Destinations& destinations,
               Clock::time_point timeout);
  /// A multicast counts once, not on every interface.
  [[nodiscard]] bool counts(const Socket* socket) const {
    return has_whitelist_ || is_first(socket);
  }

  WireLink& link_;
  DelayLine& delay_line_;
  bool has_whitelist_;
  std::atomic<Socket*> first_socket_ = nullptr;
};

}  // namespace fleetloc
