#pragma once

#include <span>

#include "shared/link/channel.hpp"
#include "shared/model/served_robot.hpp"
#include "shared/wire/malformed.hpp"

namespace fleetloc {

/// wire::ServedRobot. Throws NotEncodable.
Bytes encode(const ServedRobot& robot);

/// Ids valid, numbers finite and in range. Never throws.
Decoded<ServedRobot> decode_served_robot(std::span<const std::uint8_t> bytes);

}  // namespace fleetloc
