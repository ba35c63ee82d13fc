#pragma once

#include <cstdint>

namespace fleetloc {

/// Streams of CounterRandom, one for each stage of a link: what one stage draws for a datagram
/// depends on the seed and on how many were sent before it, never on another stage.
enum RandomStream : std::uint64_t { kLossStream, kDelayStream, kDuplicationStream };

}  // namespace fleetloc
