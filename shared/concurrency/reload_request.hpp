#pragma once

#include <atomic>

namespace fleetloc {

/// SIGHUP has come: the program is to read again, or begin anew, what it can. Any thread.
class ReloadRequest {
 public:
  void set() { is_set_ = true; }
  /// Whether it was set since the last call.
  [[nodiscard]] bool take() { return is_set_.exchange(false); }

 private:
  std::atomic<bool> is_set_ = false;
};

}  // namespace fleetloc
