#pragma once

#include <cstdint>
#include <span>

#include "shared/link/channel.hpp"
#include "shared/model/robot_status.hpp"
#include "shared/model/session.hpp"
#include "shared/wire/malformed.hpp"

namespace fleetloc {

/// Exact, but for the load, which is kept in single precision. Both throw NotEncodable for what
/// the receiver would refuse.
Bytes encode(const LocalizerStatus& status);
Bytes encode(const RobotStatus& status);

/// Neither throws.
Decoded<LocalizerStatus> decode_localizer_status(std::span<const std::uint8_t> bytes);
Decoded<RobotStatus> decode_robot_status(std::span<const std::uint8_t> bytes);

}  // namespace fleetloc
