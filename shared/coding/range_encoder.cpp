#include "shared/coding/range_encoder.hpp"

#include <cstddef>
#include <utility>

#include "shared/coding/range.hpp"

namespace fleetloc {

bool RangeEncoder::code(BitModel& model, bool bit) {
  narrow(bit, (range_ >> BitModel::kProbabilityBits) * model.probability_of_zero());
  model.learn(bit);
  return bit;
}

std::uint32_t RangeEncoder::code_raw(std::uint32_t value, int count) {
  for (int i = count; i-- > 0;) narrow(((value >> i) & 1U) != 0, range_ >> 1);
  return value;
}

// A bit takes its share of the range: zero the lower part, one the rest.
void RangeEncoder::narrow(bool bit, std::uint32_t zero_range) {
  if (bit) {
    if (low_ + zero_range < low_) carry();
    low_ += zero_range;
    range_ -= zero_range;
  } else {
    range_ = zero_range;
  }
  while (range_ < kMinRange) {
    bytes_.push_back(static_cast<std::uint8_t>(low_ >> 24));
    low_ <<= 8;
    range_ <<= 8;
  }
}

void RangeEncoder::carry() {
  for (std::size_t i = bytes_.size(); i-- > 0;) {
    if (++bytes_[i] != 0) return;
  }
}

// Any number in [low, low + range) would do: the one with most zeros at its end, which the decoder
// takes for granted.
std::vector<std::uint8_t> RangeEncoder::finish() {
  std::uint32_t number = low_;
  for (int bits = 32; bits >= 0; bits -= 8) {
    const auto rest = static_cast<std::uint32_t>((std::uint64_t{1} << bits) - 1);
    number = (low_ + rest) & ~rest;
    if (number - low_ < range_) break;
  }
  if (number < low_) carry();
  for (; number != 0; number <<= 8) bytes_.push_back(static_cast<std::uint8_t>(number >> 24));
  return std::move(bytes_);
}

}  // namespace fleetloc
