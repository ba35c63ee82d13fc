#pragma once

#include <cstdint>
#include <vector>

#include "shared/coding/bit_model.hpp"

namespace fleetloc {

/// Writes bits at the cost of their surprise: range coding (Martin, 1979) with adaptive binary
/// models. Integers alone, so the bytes are the same on every machine.
///
/// RangeDecoder has the same functions; what is coded by a template over both cannot differ.
class RangeEncoder {
 public:
  static constexpr bool kDecodes = false;

  /// @return `bit`
  bool code(BitModel& model, bool bit);

  /// The lowest `count` bits of `value`, each as likely set as not; count 0..32. @return `value`
  std::uint32_t code_raw(std::uint32_t value, int count);

  /// All that was coded, in as few bytes as tell it apart. Ends the encoder.
  std::vector<std::uint8_t> finish();

 private:
  void narrow(bool bit, std::uint32_t zero_range);
  void carry();

  std::vector<std::uint8_t> bytes_;
  std::uint32_t low_ = 0;
  std::uint32_t range_ = 0xFFFFFFFF;
};

}  // namespace fleetloc
