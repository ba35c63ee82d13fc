#pragma once

#include <memory>

#include <fastdds/rtps/transport/TransportDescriptorInterface.h>

#include "shared/transport/wire_link.hpp"

namespace fleetloc {

using TransportDescriptor = eprosima::fastdds::rtps::TransportDescriptorInterface;

/// A transport around `udp`, which must be a UDP transport, that counts what passes and emulates
/// the link. Nothing if it is not UDP.
///
/// A datagram that is sent:
/// 1. to an address without a route, or where it would arrive twice: is left out (RouteCache,
///    PeerAddressFilter);
/// 2. is counted, for each address that remains (TrafficCounter);
/// 3. waits for its time on the emulated link, or is lost there (EmulatedLink, DelayLine);
/// 4. goes to UDP.
///
/// A datagram that arrives:
/// 1. is dropped if it is malformed, and counted as such (datagram_check);
/// 2. goes straight to the participant if that has sent it itself (OwnDatagrams);
/// 3. waits for its time on the emulated link, or is lost there (EmulatedLink, DelayLine);
/// 4. is seen by what learns from it (ServerRestartDetector, PeerAddressFilter);
/// 5. is counted (TrafficCounter), and goes to the participant.
std::shared_ptr<TransportDescriptor> wire_transport(const std::shared_ptr<TransportDescriptor>& udp,
                                                    std::shared_ptr<WireLink> link);

}  // namespace fleetloc
