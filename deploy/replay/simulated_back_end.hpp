#pragma once

#include <optional>
#include <utility>

#include "robot/odometry/back_end.hpp"

namespace fleetloc {

/// For replays: the result appears a fixed time after the start, independent of this machine.
class SimulatedBackEnd final : public BackEnd {
 public:
  SimulatedBackEnd(KeyframeWorker worker, Duration duration)
      : worker_(std::move(worker)), duration_(duration) {}

  void start(KeyframeJob job, Timestamp now) override;
  std::optional<KeyframeResult> take(Timestamp now) override;

 private:
  KeyframeWorker worker_;
  Duration duration_;
  Timestamp ready_;
  std::optional<KeyframeResult> result_;
};

}  // namespace fleetloc
