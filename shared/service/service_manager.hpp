#pragma once

#include <optional>
#include <string>

#include "shared/core/arrival_time.hpp"
#include "shared/core/time.hpp"

namespace fleetloc {

/// Tells the service manager, systemd, how this program is (Type=notify, sd_notify(3)). Started by
/// anything else, it does nothing. One thread at a time.
class ServiceManager {
 public:
  /// Reads the environment: NOTIFY_SOCKET, WATCHDOG_USEC, WATCHDOG_PID.
  ServiceManager();

  /// The program has all that it needs, and works from now on.
  void ready();

  /// To be called by the loop that does the work, however little there is to do: if it hangs, the
  /// service manager hears nothing for its WatchdogSec, and starts the program anew.
  /// @param now  a clock that is not set
  void alive(ArrivalTime now);

  /// What `systemctl status` shows. Sent when it changes, at most once a second.
  void status(const std::string& text, ArrivalTime now);

  /// The program was asked to end, and is about to. Any thread.
  void stopping();

 private:
  std::optional<Duration> feed_interval_;
  std::optional<ArrivalTime> fed_;
  std::string status_;
  std::optional<ArrivalTime> told_;
};

}  // namespace fleetloc
