#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <thread>
#include <vector>

#include "cloud/pool/localizer_pool.hpp"
#include "shared/concurrency/bounded_queue.hpp"

namespace fleetloc {

/// Threads that run the jobs of a LocalizerPool.
class WorkerPool {
 public:
  struct Finished {
    LocalizerPool::Job job;
    LocalizationResult answer;
    Duration cpu{};   ///< processor time of the job
    Duration busy{};  ///< time for which the worker had it
  };

  /// @param has_finished  called by a worker when there is something to take
  WorkerPool(int threads, std::function<void()> has_finished);

  /// True if a worker is free; then start() does not wait.
  [[nodiscard]] bool has_free_worker() const { return running_ < threads_.size(); }
  void start(LocalizerPool::Job job);
  std::optional<Finished> take();

  /// Waits for the jobs that run; nothing can be started after it.
  void finish();

 private:
  void work(const std::stop_token& stop);

  std::function<void()> has_finished_;
  std::size_t running_ = 0;  // jobs whose result has not been taken
  BoundedQueue<LocalizerPool::Job> jobs_;
  BoundedQueue<Finished> finished_;
  std::vector<std::jthread> threads_;  // last: they use the others
};

}  // namespace fleetloc
