#pragma once

#include <cstddef>
#include <vector>

namespace fleetloc {

inline constexpr std::size_t kIpUdpBytes = 28;  ///< of each datagram: headers of IPv4 and UDP

/// Sizes at the IP level of the datagrams that carry a sample of `payload_bytes` to one receiver,
/// as Fast DDS makes them under the limit of qos_profiles/: one, or fragments below the MTU.
/// A datagram has 100 bytes of headers (112 with a fragment) and holds 1224 bytes of payload.
std::vector<std::size_t> datagram_sizes(std::size_t payload_bytes);

}  // namespace fleetloc
