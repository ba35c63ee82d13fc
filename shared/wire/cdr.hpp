#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "shared/cdr/cdr.hpp"
#include "shared/core/ids.hpp"
#include "shared/wire/malformed.hpp"

namespace fleetloc {

/// A sample whose ids are valid, and nothing else: its other fields are still to be checked.
/// @param ids  how many strings the type begins with. They are read in full first, because the
///             generated code would cut one that is too long, and make it another robot's.
template <typename T>
Decoded<T> from_cdr(std::span<const std::uint8_t> bytes, int ids) {
  bool are_valid = true;
  const auto read = read_cdr(bytes, [&](auto& cdr) {
    for (int i = 0; i < ids && are_valid; ++i) {
      std::string id;
      cdr >> id;
      are_valid = is_valid_id(id);
    }
  });
  if (!are_valid) return unexpected(Malformed::kInvalidId);
  std::optional<T> sample = read ? from_cdr<T>(bytes) : std::nullopt;
  if (!sample) return unexpected(Malformed::kUndecodable);
  return *std::move(sample);
}

/// A sample whose ids are valid and that passes `check`.
template <typename T>
Decoded<T> valid_from_cdr(std::span<const std::uint8_t> bytes,
                          int ids,
                          Validity (*check)(const T&)) {
  Decoded<T> sample = from_cdr<T>(bytes, ids);
  if (!sample) return sample;
  if (const Validity valid = check(*sample); !valid) return unexpected(valid.error());
  return sample;
}

}  // namespace fleetloc
