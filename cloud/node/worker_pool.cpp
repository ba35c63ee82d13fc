#include "cloud/node/worker_pool.hpp"

#include <utility>

#include "shared/core/cpu_time.hpp"

namespace fleetloc {
WorkerPool::WorkerPool(int threads, std::function<void()> has_finished)
    : has_finished_(std::move(has_finished)),
      jobs_(static_cast<std::size_t>(threads), Overflow::kBlock),
      finished_(static_cast<std::size_t>(threads), Overflow::kBlock) {
  for (int i = 0; i < threads; ++i) {
    threads_.emplace_back([this](const std::stop_token& stop) { work(stop); });
  }
}

void WorkerPool::work(const std::stop_token& stop) {
  while (auto job = jobs_.pop(stop)) {
    const auto begin = std::chrono::steady_clock::now();
    const Duration cpu_begin = thread_cpu_time();
    LocalizationResult answer = LocalizerPool::run(*job);
    const Duration cpu = thread_cpu_time() - cpu_begin;
    finished_.push(
        {std::move(*job), std::move(answer), cpu, std::chrono::steady_clock::now() - begin});
    has_finished_();
  }
}

void WorkerPool::start(LocalizerPool::Job job) {
  ++running_;
  jobs_.push(std::move(job));
}

void WorkerPool::finish() {
  jobs_.close();
  threads_.clear();
}

std::optional<WorkerPool::Finished> WorkerPool::take() {
  auto finished = finished_.try_pop();
  if (finished) --running_;
  return finished;
}

}  // namespace fleetloc
