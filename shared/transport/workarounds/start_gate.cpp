#include "shared/transport/workarounds/start_gate.hpp"

#include <utility>

namespace fleetloc {

void StartGate::close() {
  const std::lock_guard lock(mutex_);
  held_.clear();
  is_closed_ = true;
}

void StartGate::open() {
  std::vector<Send> held;
  {
    const std::lock_guard lock(mutex_);
    held = std::exchange(held_, {});
    is_closed_ = false;
  }
  for (const Send& send : held) send();
}

void StartGate::hold(Send send) {
  {
    const std::lock_guard lock(mutex_);
    if (is_closed_) {
      held_.push_back(std::move(send));
      return;
    }
  }
  send();
}

}  // namespace fleetloc
