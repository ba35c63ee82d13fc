#pragma once

#include "shared/compact/answer_sample.hpp"

namespace fleetloc {

/// An answer without corrections, as a localizer sends it.
inline Bytes encode(const LocalizationResult& answer) {
  constexpr std::size_t kDatagram = 1200;
  return encode(Answer{answer, {}}, kDatagram);
}

inline Decoded<LocalizationResult> decode_localization_result(std::span<const std::uint8_t> bytes) {
  return decode_answer(bytes).transform([](const Answer& answer) { return answer.result; });
}

}  // namespace fleetloc
