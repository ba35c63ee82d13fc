#pragma once

#include <memory>

#include "shared/transport/checked_transport.hpp"
#include "shared/transport/wire_link.hpp"

namespace fleetloc {

/// A transport around `udp`, which must be a UDP transport, that checks and counts what passes,
/// leaves out addresses, and emulates the link. The steps and their order: shared/README.md, "How a
/// datagram passes". Nothing if it is not UDP.
std::shared_ptr<TransportDescriptor> wire_transport(const std::shared_ptr<TransportDescriptor>& udp,
                                                    const RtpsLimits& limits,
                                                    std::shared_ptr<WireLink> link);

}  // namespace fleetloc
