#include "robot/pipeline/input_validator.hpp"

#include <utility>

namespace fleetloc {

std::vector<ImuSample> InputValidator::admit(const ImuSample& sample) {
  if (!sample.angular_velocity.allFinite() || !sample.specific_force.allFinite()) {
    ++refused_["imu_not_finite"];
    return {};
  }
  const std::optional<ImuSample> waiting = std::exchange(unconfirmed_, std::nullopt);
  const Duration after_waiting = waiting ? sample.stamp - waiting->stamp : Duration{};
  const bool confirms = after_waiting > Duration{} && after_waiting <= max_step_;
  if (waiting && !confirms) ++refused_["imu_ahead"];
  if (last_imu_ && sample.stamp <= *last_imu_) {
    ++refused_["imu_not_newer"];
    return {};
  }
  if (last_imu_ && !confirms && sample.stamp - *last_imu_ > max_step_) {
    unconfirmed_ = sample;
    return {};
  }
  last_imu_ = sample.stamp;
  if (confirms) return {*waiting, sample};
  return {sample};
}

std::string_view InputValidator::check_frame(Timestamp stamp) {
  std::string_view reason;
  if (last_frame_ && stamp <= *last_frame_) reason = "frame_not_newer";
  if (!last_imu_ || stamp - *last_imu_ > max_step_) reason = "frame_ahead_of_imu";
  if (reason.empty()) {
    last_frame_ = stamp;
  } else {
    ++refused_[std::string(reason)];
  }
  return reason;
}

}  // namespace fleetloc
