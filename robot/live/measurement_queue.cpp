#include "robot/live/measurement_queue.hpp"

#include <algorithm>
#include <utility>
#include <variant>

namespace fleetloc {
namespace {

template <typename Measurement>
bool is(const SensorMeasurement& any) {
  return std::holds_alternative<Measurement>(any);
}

}  // namespace

void MeasurementQueue::push(SensorMeasurement measurement) {
  if (is<CameraFrame>(measurement)) {
    make_room<CameraFrame>(max_frames_, dropped_frames_);
  } else if (is<ImuSample>(measurement)) {
    make_room<ImuSample>(max_imu_, dropped_imu_);
  } else if (auto* step = std::get_if<ClockStep>(&measurement)) {
    merge_steps(*step);
  }
  queue_.push_back(std::move(measurement));
}

template <typename Measurement>
void MeasurementQueue::make_room(std::size_t max, std::uint64_t& dropped) {
  if (static_cast<std::size_t>(std::ranges::count_if(queue_, is<Measurement>)) < max) return;
  queue_.erase(std::ranges::find_if(queue_, is<Measurement>));
  ++dropped;
}

// What nobody has taken before the next step is of a clock that does not hold any more.
void MeasurementQueue::merge_steps(ClockStep& step) {
  const auto before = std::ranges::find_if(queue_, is<ClockStep>);
  if (before == queue_.end()) return;
  step.unseen += std::get<ClockStep>(*before).unseen;
  dropped_frames_ +=
      static_cast<std::uint64_t>(std::count_if(before, queue_.end(), is<CameraFrame>));
  dropped_imu_ += static_cast<std::uint64_t>(std::count_if(before, queue_.end(), is<ImuSample>));
  queue_.erase(before, queue_.end());
}

std::optional<SensorMeasurement> MeasurementQueue::take() {
  if (queue_.empty()) return std::nullopt;
  SensorMeasurement measurement = std::move(queue_.front());
  queue_.pop_front();
  return measurement;
}

}  // namespace fleetloc
