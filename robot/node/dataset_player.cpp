#include "robot/node/dataset_player.hpp"

#include <condition_variable>
#include <mutex>
#include <utility>

#include "shared/core/cpu_time.hpp"

namespace fleetloc {
namespace {

constexpr std::size_t kAhead = 64;  // items, of which one in eleven or so is an image pair

}  // namespace

DatasetPlayer::DatasetPlayer(DatasetReader input, double rate)
    : input_(std::move(input)),
      rate_(rate),
      played_(kAhead, Overflow::kBlock),
      thread_([this](const std::stop_token& stop) { play(stop); }) {}

std::optional<DatasetPlayer::Played> DatasetPlayer::next(const std::stop_token& stop) {
  auto played = played_.pop(stop);
  if (!played && !stop.stop_requested() && error_) std::rethrow_exception(error_);
  return played;
}

void DatasetPlayer::stop() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
}

void DatasetPlayer::play(const std::stop_token& stop) {
  try {
    while (!stop.stop_requested()) {
      const Duration begin = thread_cpu_time();
      auto item = input_.next();
      if (!item) break;
      const Duration cpu = thread_cpu_time() - begin;
      wait_for(stamp_of(*item), stop);
      played_.push({std::move(*item), cpu}, stop);
    }
  } catch (...) {
    error_ = std::current_exception();
  }
  played_.close();
}

void DatasetPlayer::wait_for(Timestamp stamp, const std::stop_token& stop) {
  if (rate_ <= 0.0) return;
  if (!first_stamp_) {
    first_stamp_ = stamp;
    started_ = std::chrono::steady_clock::now();
  }
  const auto due = started_ + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                  (stamp - *first_stamp_) / rate_);
  std::mutex mutex;
  std::unique_lock lock(mutex);
  std::condition_variable_any never;  // only a stop ends the wait early
  never.wait_until(lock, stop, due, [] { return false; });
}

}  // namespace fleetloc
