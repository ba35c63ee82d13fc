#include "shared/transport/ros2/arrival_queue.hpp"

#include <cassert>
#include <utility>

namespace fleetloc {

ArrivalQueue::ArrivalQueue(const std::vector<std::size_t>& capacities) {
  for (const std::size_t capacity : capacities) {
    assert(capacity > 0);
    topics_.push_back({.capacity = capacity, .waiting = {}});
  }
}

void ArrivalQueue::push(Ros2Sample sample) {
  const std::lock_guard lock(mutex_);
  Topic& topic = topics_.at(sample.topic);
  if (topic.waiting.size() == topic.capacity) {
    topic.waiting.pop_front();
    ++topic.dropped;
  }
  topic.waiting.push_back({.number = arrivals_++, .sample = std::move(sample)});
  arrived_.notify_one();
}

std::optional<Ros2Sample> ArrivalQueue::pop(const std::stop_token& stop,
                                            std::chrono::milliseconds max_wait) {
  std::unique_lock lock(mutex_);
  Topic* topic = nullptr;
  arrived_.wait_for(lock, stop, max_wait, [&] { return (topic = first_arrived()) != nullptr; });
  if (topic == nullptr || stop.stop_requested()) return std::nullopt;
  Ros2Sample sample = std::move(topic->waiting.front().sample);
  topic->waiting.pop_front();
  return sample;
}

ArrivalQueue::Topic* ArrivalQueue::first_arrived() {
  Topic* first = nullptr;
  for (Topic& topic : topics_) {
    if (topic.waiting.empty()) continue;
    const bool is_earlier =
        first == nullptr || topic.waiting.front().number < first->waiting.front().number;
    if (is_earlier) first = &topic;
  }
  return first;
}

std::uint64_t ArrivalQueue::dropped(std::size_t topic) const {
  const std::lock_guard lock(mutex_);
  return topics_.at(topic).dropped;
}

}  // namespace fleetloc
