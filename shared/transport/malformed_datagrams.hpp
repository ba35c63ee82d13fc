#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <map>
#include <string>

#include "shared/transport/workarounds/datagram_check.hpp"

namespace fleetloc {

/// Counts datagrams that were dropped before Fast DDS saw them. Any thread may use any function.
class MalformedDatagrams {
 public:
  void add(RtpsDefect defect);

  /// By the name of their defect, without those that were not met.
  [[nodiscard]] std::map<std::string, std::uint64_t> counts() const;

 private:
  std::array<std::atomic<std::uint64_t>, kRtpsDefects> counts_{};  // by defect
};

}  // namespace fleetloc
