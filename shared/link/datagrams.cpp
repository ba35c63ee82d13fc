#include "shared/link/datagrams.hpp"

#include <algorithm>

namespace fleetloc {
namespace {

// Measured on Fast DDS 2.9.1 with maxMessageSize 1400; test/transport compares the two. The library
// keeps 60 bytes free for its statistics, which shared/transport leaves out.
constexpr std::size_t kRtpsBytes = 20;         // header
constexpr std::size_t kDestinationBytes = 16;  // submessage INFO_DST
constexpr std::size_t kTimestampBytes = 12;    // submessage INFO_TS
constexpr std::size_t kCommonBytes = kIpUdpBytes + kRtpsBytes + kDestinationBytes + kTimestampBytes;
constexpr std::size_t kWholeBytes = 24;        // submessage DATA before its payload
constexpr std::size_t kFragmentBytes = 36;     // submessage DATA_FRAG before its payload
constexpr std::size_t kLargestPayload = 1224;  // in one datagram

// Submessages are aligned to four bytes.
constexpr std::size_t padded(std::size_t bytes) {
  return (bytes + 3) / 4 * 4;
}

}  // namespace

std::vector<std::size_t> datagram_sizes(std::size_t payload_bytes) {
  if (payload_bytes <= kLargestPayload) return {kCommonBytes + kWholeBytes + padded(payload_bytes)};
  std::vector<std::size_t> sizes;
  for (std::size_t sent = 0; sent < payload_bytes; sent += kLargestPayload) {
    const std::size_t part = std::min(kLargestPayload, payload_bytes - sent);
    sizes.push_back(kCommonBytes + kFragmentBytes + padded(part));
  }
  return sizes;
}

}  // namespace fleetloc
