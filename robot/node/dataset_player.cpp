#include "robot/node/dataset_player.hpp"

#include <condition_variable>
#include <mutex>
#include <utility>

namespace fleetloc {
namespace {

constexpr std::size_t kAhead = 64;  // measurements, of which one in eleven or so is an image pair

}  // namespace

DatasetPlayer::DatasetPlayer(std::unique_ptr<SensorSource> recording, double rate)
    : recording_(std::move(recording)),
      frame_count_(recording_->frame_count()),
      rate_(rate),
      played_(kAhead, Overflow::kBlock),
      thread_([this](const std::stop_token& stop) { play(stop); }) {}

std::optional<SensorMeasurement> DatasetPlayer::next(const std::stop_token& stop) {
  auto played = played_.pop(stop);
  if (!played && !stop.stop_requested() && error_) std::rethrow_exception(error_);
  return played;
}

std::map<std::string, std::uint64_t> DatasetPlayer::close() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
  return recording_->close();
}

void DatasetPlayer::play(const std::stop_token& stop) {
  try {
    while (auto measurement = recording_->next(stop)) {
      wait_for(stamp_of(*measurement), stop);
      played_.push(std::move(*measurement), stop);
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
