#pragma once

#include "shared/wire/malformed.hpp"
#include "test/fuzz/target.hpp"

namespace fleetloc {

/// What has been decoded is encoded to bytes that mean the same, bit by bit.
template <typename Decoded, typename Decode>
void expect_exact(const Decoded& decoded, const Decode& decode) {
  if (!decoded) return;
  const auto bytes = encode(*decoded);
  const auto again = decode(bytes);
  require(again.has_value(), "what was decoded is decoded again");
  require(encode(*again) == bytes, "what was decoded twice is the same");
}

/// The same for values that are rounded, some of which the encoder refuses.
template <typename Decoded, typename Decode>
void expect_decodable(const Decoded& decoded, const Decode& decode) {
  if (!decoded) return;
  try {
    require(decode(encode(*decoded)).has_value(), "what was decoded is decoded again");
  } catch (const NotEncodable&) {  // a matrix whose root is out of range
  }
}

}  // namespace fleetloc
