#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "shared/wire/malformed.hpp"

namespace fleetloc {

/// Writes strictly increasing values as gaps of one byte; see submap.idl.
template <typename Wide>
class GapWriter {
 public:
  GapWriter(std::vector<std::uint8_t>& gaps, std::vector<Wide>& wide) : gaps_(gaps), wide_(wide) {}

  void push(std::int64_t value) {
    const std::int64_t gap = value - previous_;
    const bool fits = gap >= 1 && gap <= std::numeric_limits<std::uint8_t>::max();
    gaps_.push_back(fits ? static_cast<std::uint8_t>(gap) : std::uint8_t{0});
    if (!fits) wide_.push_back(static_cast<Wide>(value));
    previous_ = value;
  }

  void restart() { previous_ = -1; }

 private:
  std::vector<std::uint8_t>& gaps_;
  std::vector<Wide>& wide_;
  std::int64_t previous_ = -1;
};

/// Reads what GapWriter has written. Expects as many wide entries as there are gaps of zero.
template <typename Wide>
class GapReader {
 public:
  GapReader(std::span<const std::uint8_t> gaps, std::span<const Wide> wide)
      : gaps_(gaps), wide_(wide) {}

  /// The next value; nothing if it is not above the one before it.
  std::optional<std::int64_t> next() {
    const std::int64_t gap = gaps_[gap_index_++];
    const std::int64_t value =
        gap > 0 ? previous_ + gap : static_cast<std::int64_t>(wide_[wide_index_++]);
    if (value <= previous_) return std::nullopt;
    previous_ = value;
    return value;
  }

  void restart() { previous_ = -1; }

 private:
  std::span<const std::uint8_t> gaps_;
  std::span<const Wide> wide_;
  std::size_t gap_index_ = 0;
  std::size_t wide_index_ = 0;
  std::int64_t previous_ = -1;
};

inline std::size_t wide_entries(std::span<const std::uint8_t> gaps) {
  return static_cast<std::size_t>(std::ranges::count(gaps, std::uint8_t{0}));
}

/// round(value * units) as an Integer; throws NotEncodable with `what` if it does not fit.
template <typename Integer>
Integer quantized(double value, double units, const char* what) {
  const double scaled = std::round(value * units);
  constexpr auto kMin = static_cast<double>(std::numeric_limits<Integer>::min());
  constexpr auto kMax = static_cast<double>(std::numeric_limits<Integer>::max());
  if (!(scaled >= kMin && scaled <= kMax)) throw NotEncodable(what);
  return static_cast<Integer>(scaled);
}

}  // namespace fleetloc
