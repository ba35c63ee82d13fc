#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "shared/coding/bit_model.hpp"

namespace fleetloc {

/// How likely each integer of one kind is: small ones cost little, none is impossible. n + 1 is
/// coded as the number of its bits (one flag a bit, each with its model), then the bits below the
/// leading one, of which the first two have models. A sign follows, if there is one.
class IntegerModel {
 public:
  static constexpr std::size_t kMaxLength = 32;  // of the bits below the leading one

  template <typename Coder>
  std::uint32_t code(Coder& coder, std::uint32_t value);

  /// Within +-(2^31 - 2).
  template <typename Coder>
  std::int32_t code_signed(Coder& coder, std::int32_t value);

  /// See model_rows.hpp.
  template <typename Visit>
  void for_each_row(const std::string& name, const Visit& visit) {
    visit(name + ".longer", std::span<BitModel>(longer_));
    visit(name + ".first", std::span<BitModel>(first_));
    visit(name + ".second", std::span<BitModel>(second_));
    visit(name + ".negative", std::span<BitModel>(&negative_, 1));
  }

 private:
  static constexpr std::size_t kShaped = 11;  // up to this length bits have models

  std::array<BitModel, kMaxLength> longer_;       // than 0, 1, ...
  std::array<BitModel, kShaped> first_;           // of length 1, 2, ...
  std::array<BitModel, 2 * kShaped - 2> second_;  // of length 2 after 0, after 1; of length 3 ...
  BitModel negative_;
};

template <typename Coder>
std::uint32_t IntegerModel::code(Coder& coder, std::uint32_t value) {
  const std::uint64_t shifted = std::uint64_t{value} + 1;
  const std::size_t value_length = static_cast<std::size_t>(std::bit_width(shifted)) - 1;
  std::size_t length = 0;  // of the bits below the leading one
  while (length < kMaxLength && coder.code(longer_[length], length < value_length)) ++length;
  std::uint64_t result = 1;
  std::size_t left = length;
  const auto bit_at = [&](std::size_t place) { return ((shifted >> place) & 1U) != 0; };
  if (length <= kShaped && left > 0) {
    const bool first = coder.code(first_[length - 1], bit_at(--left));
    result = 2 * result + (first ? 1 : 0);
    if (left > 0) {
      const std::size_t place = 2 * (length - 2) + (first ? 1 : 0);
      const bool second = coder.code(second_[place], bit_at(--left));
      result = 2 * result + (second ? 1 : 0);
    }
  }
  const auto rest = static_cast<std::uint32_t>(shifted & ((std::uint64_t{1} << left) - 1));
  result = (result << left) | coder.code_raw(rest, static_cast<int>(left));
  return static_cast<std::uint32_t>(result - 1);
}

template <typename Coder>
std::int32_t IntegerModel::code_signed(Coder& coder, std::int32_t value) {
  const auto size = static_cast<std::uint32_t>(value < 0 ? -std::int64_t{value} : value);
  const std::uint32_t coded = code(coder, size) & 0x7FFFFFFFU;
  if (coded == 0) return 0;
  const bool is_negative = coder.code(negative_, value < 0);
  return is_negative ? -static_cast<std::int32_t>(coded) : static_cast<std::int32_t>(coded);
}

}  // namespace fleetloc
