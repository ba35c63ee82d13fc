#pragma once

#include <memory>

#include <fastdds/rtps/transport/TransportDescriptorInterface.h>

#include "shared/transport/malformed_datagrams.hpp"
#include "shared/transport/workarounds/datagram_check.hpp"

namespace fleetloc {

using TransportDescriptor = eprosima::fastdds::rtps::TransportDescriptorInterface;

/// A transport around `udp`, which must be a UDP transport, that passes on to Fast DDS only what is
/// well formed. Nothing if it is not UDP.
/// @param refused  counts the others
std::shared_ptr<TransportDescriptor> checked_transport(
    const std::shared_ptr<TransportDescriptor>& udp,
    const RtpsLimits& limits,
    std::shared_ptr<MalformedDatagrams> refused);

}  // namespace fleetloc
