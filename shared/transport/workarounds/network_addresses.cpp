#include "shared/transport/workarounds/network_addresses.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

namespace fleetloc {
namespace {

int netlink_socket() {
  const int descriptor = socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, NETLINK_ROUTE);
  if (descriptor < 0) return -1;
  sockaddr_nl address{};
  address.nl_family = AF_NETLINK;
  address.nl_groups = RTMGRP_LINK | RTMGRP_IPV4_IFADDR;
  if (bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0) {
    return descriptor;
  }
  close(descriptor);
  return -1;
}

std::string text_of(const in_addr& address) {
  std::array<char, INET_ADDRSTRLEN> text{};
  inet_ntop(AF_INET, &address, text.data(), static_cast<socklen_t>(text.size()));
  return text.data();
}

void add_removed(const nlmsghdr& message, InterfaceAddresses& removed) {
  if (message.nlmsg_type != RTM_DELADDR) return;
  const auto* about = static_cast<const ifaddrmsg*>(NLMSG_DATA(&message));
  if (about->ifa_family != AF_INET) return;
  const auto* attributes = reinterpret_cast<const char*>(IFA_RTA(about));
  const std::size_t size = IFA_PAYLOAD(&message);
  rtattr attribute{};
  for (std::size_t at = 0; at + RTA_LENGTH(sizeof(in_addr)) <= size;
       at += RTA_ALIGN(std::max<std::size_t>(attribute.rta_len, sizeof attribute))) {
    std::memcpy(&attribute, attributes + at, sizeof attribute);
    if (attribute.rta_type != IFA_LOCAL) continue;
    in_addr address{};
    std::memcpy(&address, attributes + at + RTA_LENGTH(0), sizeof address);
    removed.insert({.interface_index = about->ifa_index, .address = text_of(address)});
  }
}

// Messages that did not fit are an error of the socket (ENOBUFS), and gone after it.
InterfaceAddresses read_removals(int descriptor) {
  InterfaceAddresses removed;
  alignas(nlmsghdr) std::array<char, 32768> buffer{};
  while (true) {
    const ssize_t size = recv(descriptor, buffer.data(), buffer.size(), 0);
    if (size < 0 && errno == ENOBUFS) continue;
    if (size <= 0) return removed;
    auto left = static_cast<unsigned>(size);
    for (const auto* it = reinterpret_cast<const nlmsghdr*>(buffer.data()); NLMSG_OK(it, left);
         it = NLMSG_NEXT(it, left)) {
      add_removed(*it, removed);
    }
  }
}

}  // namespace

InterfaceAddresses interface_addresses(const std::vector<std::string>& named) {
  ifaddrs* first = nullptr;
  if (getifaddrs(&first) != 0) return {};
  InterfaceAddresses addresses;
  for (const ifaddrs* it = first; it != nullptr; it = it->ifa_next) {
    if (it->ifa_addr == nullptr || it->ifa_addr->sa_family != AF_INET) continue;
    if ((it->ifa_flags & IFF_UP) == 0) continue;
    std::string address = text_of(reinterpret_cast<const sockaddr_in*>(it->ifa_addr)->sin_addr);
    const bool counts = named.empty() ? (it->ifa_flags & IFF_LOOPBACK) == 0
                                      : std::ranges::find(named, address) != named.end();
    if (!counts) continue;
    addresses.insert(
        {.interface_index = if_nametoindex(it->ifa_name), .address = std::move(address)});
  }
  freeifaddrs(first);
  return addresses;
}

// A datagram socket sends nothing when it is connected.
bool has_route(std::uint32_t address) {
  sockaddr_in destination{};
  destination.sin_family = AF_INET;
  destination.sin_port = htons(9);  // any
  destination.sin_addr.s_addr = htonl(address);
  const int descriptor = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return true;  // unknown: let the sending itself fail
  const bool routed =
      connect(descriptor, reinterpret_cast<const sockaddr*>(&destination), sizeof(destination)) ==
      0;
  close(descriptor);
  return routed;
}

AddressWatch::AddressWatch()
    : changes_(netlink_socket()), wake_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (wake_ >= 0) return;
  const std::error_code reason(errno, std::generic_category());
  if (changes_ >= 0) close(changes_);
  throw std::system_error(reason, "eventfd");
}

AddressWatch::~AddressWatch() {
  if (changes_ >= 0) close(changes_);
  close(wake_);
}

InterfaceAddresses AddressWatch::wait(std::chrono::milliseconds limit,
                                      const std::stop_token& stop) {
  const std::stop_callback wake(stop, [this] { eventfd_write(wake_, 1); });
  std::array<pollfd, 2> descriptors{{{.fd = wake_, .events = POLLIN, .revents = 0},
                                     {.fd = changes_, .events = POLLIN, .revents = 0}}};
  poll(descriptors.data(), descriptors.size(), static_cast<int>(limit.count()));
  return changes_ >= 0 ? read_removals(changes_) : InterfaceAddresses();
}

}  // namespace fleetloc
