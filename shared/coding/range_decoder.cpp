#include "shared/coding/range_decoder.hpp"

#include "shared/coding/range.hpp"

namespace fleetloc {

RangeDecoder::RangeDecoder(std::span<const std::uint8_t> bytes) : bytes_(bytes) {
  for (int i = 0; i < 4; ++i) above_low_ = (above_low_ << 8) | next_byte();
}

bool RangeDecoder::code(BitModel& model, bool /*ignored*/) {
  const bool bit = narrow((range_ >> BitModel::kProbabilityBits) * model.probability_of_zero());
  model.learn(bit);
  return bit;
}

std::uint32_t RangeDecoder::code_raw(std::uint32_t /*ignored*/, int count) {
  std::uint32_t value = 0;
  for (int i = 0; i < count; ++i) value = (value << 1) | (narrow(range_ >> 1) ? 1U : 0U);
  return value;
}

bool RangeDecoder::narrow(std::uint32_t zero_range) {
  const bool bit = above_low_ >= zero_range;
  if (bit) {
    above_low_ -= zero_range;
    range_ -= zero_range;
  } else {
    range_ = zero_range;
  }
  while (range_ < kMinRange) {
    above_low_ = (above_low_ << 8) | next_byte();
    range_ <<= 8;
  }
  return bit;
}

}  // namespace fleetloc
