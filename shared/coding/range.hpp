#pragma once

#include <cstdint>

namespace fleetloc {

/// The interval of encoder and decoder is never narrower: below it a byte is written, or read.
inline constexpr std::uint32_t kMinRange = 1U << 24;

}  // namespace fleetloc
