#pragma once

#include <array>
#include <charconv>
#include <string>

namespace fleetloc {

/// The shortest text that reads back as the same number.
inline std::string exact_text(double value) {
  std::array<char, 32> digits{};
  auto* const end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  return {digits.data(), end};
}

}  // namespace fleetloc
