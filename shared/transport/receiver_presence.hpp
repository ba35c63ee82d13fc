#pragma once

#include <chrono>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace fleetloc {

/// Which receivers are gone for so long that the writers to them are not worth keeping. No clock.
class ReceiverPresence {
 public:
  using Time = std::chrono::steady_clock::time_point;

  explicit ReceiverPresence(std::chrono::seconds patience) : patience_(patience) {}

  /// To be called regularly.
  /// @param receivers  to whom there are writers
  /// @param present    those of them whose readers are matched
  /// @return those that have not been present for longer than the patience; they are forgotten
  std::vector<std::string> absent(const std::set<std::string>& receivers,
                                  const std::set<std::string>& present,
                                  Time now);

 private:
  std::chrono::seconds patience_;
  std::map<std::string, Time> seen_;
};

}  // namespace fleetloc
