#pragma once

#include <fastdds/rtps/common/Locator.h>
#include <fastrtps/utils/IPLocator.h>

#include "shared/transport/workarounds/peer_address_filter.hpp"

namespace fleetloc {

/// Address and port of an IPv4 locator, as the workarounds compare them; the first byte of the
/// address is the highest.
inline PeerAddressFilter::Locator locator_of(const eprosima::fastrtps::rtps::Locator_t& locator) {
  const auto* bytes = eprosima::fastrtps::rtps::IPLocator::getIPv4(locator);
  std::uint32_t address = 0;
  for (int i = 0; i < 4; ++i) address = address << 8U | bytes[i];
  return {.address = address, .port = locator.port};
}

}  // namespace fleetloc
