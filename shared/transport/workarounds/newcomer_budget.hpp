#pragma once

// Works around: Fast DDS 2.9.1 makes room for every participant that announces itself, for as long
// as it says that it will be there, and sends it what it sends to all.
// Delete when: the library bounds that by address.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>

namespace fleetloc {

/// How many participants may be new: 1000 from one address at once and two a second after that, a
/// site with all its robots behind one address; 3000 from all addresses, and 20 a second.
class NewcomerBudget {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// @param address  any IPv4 address, in any one byte order
  /// @return false if there are too many
  bool spend(std::uint32_t address, Time now);

  static constexpr double kOfAddress = 1000.0;
  static constexpr double kOfAddressPerSecond = 2.0;
  static constexpr double kOfAll = 3000.0;
  static constexpr double kOfAllPerSecond = 20.0;

 private:
  struct Left {
    double count = 0.0;
    Time at{};

    [[nodiscard]] double now(Time now, double per_second, double at_most) const;
  };

  void forget_idle(Time now);

  std::map<std::uint32_t, Left> addresses_;
  Left all_{.count = kOfAll, .at = {}};
};

}  // namespace fleetloc
