#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "shared/coding/bit_model.hpp"

namespace fleetloc {

/// Reads what RangeEncoder has written, with the same calls; the values passed in are ignored. Any
/// bytes can be read: whoever reads checks what comes out.
class RangeDecoder {
 public:
  static constexpr bool kDecodes = true;

  /// @param bytes  must outlive the decoder
  explicit RangeDecoder(std::span<const std::uint8_t> bytes);

  bool code(BitModel& model, bool ignored = false);
  std::uint32_t code_raw(std::uint32_t ignored, int count);

  /// More was read than an encoder has written.
  [[nodiscard]] bool is_overrun() const { return next_ > bytes_.size() + 4; }

 private:
  bool narrow(std::uint32_t zero_range);
  std::uint32_t next_byte() {
    const std::size_t place = next_++;
    return place < bytes_.size() ? bytes_[place] : 0;
  }

  std::span<const std::uint8_t> bytes_;
  std::size_t next_ = 0;
  std::uint32_t above_low_ = 0;  // the number that the bytes state, less the encoder's low end
  std::uint32_t range_ = 0xFFFFFFFF;
};

}  // namespace fleetloc
