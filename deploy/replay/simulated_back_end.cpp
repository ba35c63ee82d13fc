#include "deploy/replay/simulated_back_end.hpp"

#include <cassert>

namespace fleetloc {

void SimulatedBackEnd::start(KeyframeJob job, Timestamp now) {
  assert(!result_.has_value());
  result_ = worker_.run(job);
  ready_ = now + duration_;
}

std::optional<KeyframeResult> SimulatedBackEnd::take(Timestamp now) {
  if (!result_ || now < ready_) return std::nullopt;
  return std::exchange(result_, std::nullopt);
}

}  // namespace fleetloc
