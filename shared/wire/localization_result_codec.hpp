#pragma once

#include <cstdint>
#include <span>

#include "shared/link/channel.hpp"
#include "shared/model/localization_result.hpp"
#include "shared/wire/malformed.hpp"

namespace fleetloc {

/// Exact, but for the covariance (square_root_of); poses and covariance are left out, as identity
/// and zero, unless the status is kLocalized; oldest_stamp is stamp then. Throws NotEncodable for
/// what the receiver would refuse.
Bytes encode(const LocalizationResult& answer);

/// Never throws.
Decoded<LocalizationResult> decode_localization_result(std::span<const std::uint8_t> bytes);

}  // namespace fleetloc
