#pragma once

#include <cstdint>
#include <span>

#include "shared/link/channel.hpp"
#include "shared/model/session.hpp"
#include "shared/wire/malformed.hpp"

namespace fleetloc {

/// Exact, but for the covariance (square_root_of). Throws NotEncodable for what the receiver would
/// refuse.
Bytes encode(const RobotSession& session);

/// Never throws.
Decoded<RobotSession> decode_robot_session(std::span<const std::uint8_t> bytes);

}  // namespace fleetloc
