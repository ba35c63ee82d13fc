#pragma once

#include <exception>
#include <optional>
#include <thread>
#include <utility>
#include <variant>

#include "robot/odometry/back_end.hpp"
#include "shared/concurrency/bounded_queue.hpp"

namespace fleetloc {

/// Runs the back end on a thread of its own. What the thread throws, take() throws.
class ThreadedBackEnd final : public BackEnd {
 public:
  explicit ThreadedBackEnd(KeyframeWorker worker);

  void start(KeyframeJob job, Timestamp now) override;
  std::optional<KeyframeResult> take(Timestamp now) override;

 private:
  void work(const std::stop_token& stop);

  KeyframeWorker worker_;  // used by the thread only
  BoundedQueue<KeyframeJob> jobs_{1, Overflow::kBlock};
  BoundedQueue<std::variant<KeyframeResult, std::exception_ptr>> results_{1, Overflow::kBlock};
  std::jthread thread_;  // last: uses the others
};

}  // namespace fleetloc
