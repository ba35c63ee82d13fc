#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace fleetloc {

/// What the kernel has dropped because the receive buffers of sockets were full.
struct BufferLoss {
  std::uint64_t datagrams = 0;
  int buffer_bytes = 0;  ///< the smallest of those buffers; 0 if nothing was dropped
};

/// Of this process's UDP sockets on the ports of a DDS domain, since they were opened. Nothing
/// where the kernel does not tell. It reads /proc: once a second is often enough.
BufferLoss buffer_loss(std::uint32_t domain);

/// Receive buffers of sockets [bytes], by the inodes that the kernel lists them with.
using SocketBuffers = std::map<std::uint64_t, int>;

/// The same from the text of /proc/net/udp, of these sockets. Lines that are not as expected are
/// left out.
BufferLoss buffer_loss(const std::string& proc_net_udp,
                       const SocketBuffers& sockets,
                       std::uint32_t domain);

/// One line that says which setting to raise, and to what.
/// @param rmem_max_bytes  net.core.rmem_max: no socket gets more
std::string buffer_advice(const BufferLoss& loss, int rmem_max_bytes);

/// net.core.rmem_max as it is [bytes]; 0 if the kernel does not tell.
int rmem_max_bytes();

}  // namespace fleetloc
