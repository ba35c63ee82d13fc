#pragma once

// Works around: Fast DDS 2.9.1 does not watch the addresses of the computer after a participant was
// created.
// Delete when: as participant_recreation_policy.hpp; then also has_route(), which tells which of
// the addresses that Fast DDS sends to are reached at all.

#include <chrono>
#include <compare>
#include <cstdint>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

namespace fleetloc {

/// An IPv4 address of this computer. An interface that was removed and added again has a new index.
struct InterfaceAddress {
  std::uint32_t interface_index = 0;
  std::string address;
  auto operator<=>(const InterfaceAddress&) const = default;  // NOLINT(modernize-use-nullptr)
};
using InterfaceAddresses = std::set<InterfaceAddress>;

/// Those of the interfaces that are up: without loopback, or, if any are named, those named.
InterfaceAddresses interface_addresses(const std::vector<std::string>& named);

/// Whether the kernel has a route to an IPv4 address; three system calls. See RouteCache.
/// @param address  its first byte the highest
bool has_route(std::uint32_t address);

/// Notifies of changes of this computer's addresses (netlink).
class AddressWatch {
 public:
  AddressWatch();
  ~AddressWatch();
  AddressWatch(const AddressWatch&) = delete;
  AddressWatch& operator=(const AddressWatch&) = delete;

  /// Waits for a change, a requested stop, or the limit. Without netlink, for the limit. Returns
  /// the addresses that were removed since the last call, though they may be back by now.
  InterfaceAddresses wait(std::chrono::milliseconds limit, const std::stop_token& stop);

 private:
  int changes_ = -1;  // a netlink socket
  int wake_ = -1;     // an eventfd
};

}  // namespace fleetloc
