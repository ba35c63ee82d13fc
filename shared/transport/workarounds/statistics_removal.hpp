#pragma once

// Works around: Fast DDS 2.9.1, as Debian builds it (FASTDDS_STATISTICS), puts 60 bytes of
// statistics behind every RTPS message, whether or not anybody reads them.
// Delete when: the library is built without them, or leaves them out unless they are turned on.

#include "shared/transport/workarounds/rtps_message.hpp"

namespace fleetloc {

/// The datagram without the library's statistics at its end, or as it is if it has none.
///
/// The library's UDP transport fills the statistics in, wherever it finds their mark 60 bytes
/// before the end. Where another mark would come to stand there they are left in, one time in 256:
/// what precedes them would be overwritten.
RtpsBytes without_statistics(RtpsBytes datagram);

}  // namespace fleetloc
