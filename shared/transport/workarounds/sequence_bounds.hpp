#pragma once

// Works around: a reader of Fast DDS 2.9.1 takes any sequence number of a known writer, and all
// lower ones are old from then on: one forged sample makes it deaf for that writer.
// Delete when: the library does not believe leaps that no writer makes.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>

namespace fleetloc {

/// How far the writers of one participant can have come: a thousand samples beyond the latest
/// number that was seen, and a thousand more for each second since. Their first number is believed.
class SequenceBounds {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// @param writer  entity of the participant
  /// @param number  of a sample that it has, or says that it has
  /// @return false if it cannot have come so far
  bool passes(std::uint32_t writer, std::int64_t number, Time now);

  static constexpr std::int64_t kLeap = 1000;
  static constexpr double kNumbersPerSecond = 1000.0;
  static constexpr std::size_t kMaxWriters = 4096;  // a localizer has one for each robot

 private:
  struct Writer {
    std::int64_t highest = 0;
    Time seen{};
  };

  std::map<std::uint32_t, Writer> writers_;
};

}  // namespace fleetloc
