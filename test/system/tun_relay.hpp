#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <thread>

#include "test/system/network_namespace.hpp"

namespace fleetloc {

/// A line between two computers: the interface `wan0` in each, and what carries packets from one to
/// the other, each as much later as the line is long. The kernel's own emulator of delays is not
/// everywhere.
class TunRelay {
 public:
  static constexpr const char* kAddressA = "10.78.0.1";
  static constexpr const char* kAddressB = "10.78.0.2";

  /// Why it is not possible here; nothing if it is.
  static std::optional<std::string> why_impossible();

  TunRelay(const NetworkNamespace& a, const NetworkNamespace& b, std::chrono::milliseconds delay);

 private:
  OwnedDescriptor a_, b_;
  std::chrono::milliseconds delay_;
  std::jthread thread_;  // last: it uses the others
};

}  // namespace fleetloc
