#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace fleetloc {

/// The program that wrote a message, as far as the network can tell.
struct MessageSender {
  /// Its end of the network; with keys, the subject of its certificate. Zeros: not known.
  std::array<std::uint8_t, 12> participant{};
  std::uint32_t address = 0;  ///< IPv4, of its computer; 0: not known

  [[nodiscard]] bool is_known() const { return participant != decltype(participant){}; }
  /// The ends that one run of a program has, one after the other, begin alike.
  [[nodiscard]] bool is_same_program(const MessageSender& other) const {
    constexpr std::size_t kProgramBytes = 8;
    return std::equal(
        participant.begin(), participant.begin() + kProgramBytes, other.participant.begin());
  }
  [[nodiscard]] bool is_same_computer(const MessageSender& other) const {
    return address != 0 && address == other.address;
  }
};

}  // namespace fleetloc
