#include "robot/pipeline/input_validator.hpp"

#include <utility>

namespace fleetloc {

std::string_view name(InputRejection reason) {
  switch (reason) {
    case InputRejection::kImuNotNewer:
      return "imu_not_newer";
    case InputRejection::kImuImpossible:
      return "imu_impossible";
    case InputRejection::kImuAhead:
      return "imu_ahead";
    case InputRejection::kFrameNotNewer:
      return "frame_not_newer";
    case InputRejection::kFrameAheadOfImu:
      return "frame_ahead_of_imu";
  }
  return "unknown";
}

unexpected<InputRejection> InputValidator::rejection(InputRejection reason) {
  ++counts_[reason];
  return unexpected(reason);
}

expected<std::vector<ImuSample>, InputRejection> InputValidator::check_imu(
    const ImuSample& sample) {
  if (!is_possible(sample)) return rejection(InputRejection::kImuImpossible);
  const std::optional<ImuSample> waiting = std::exchange(unconfirmed_, std::nullopt);
  const Duration after_waiting = waiting ? sample.stamp - waiting->stamp : Duration{};
  const bool confirms = after_waiting > Duration{} && after_waiting <= max_step_;
  if (waiting && !confirms) ++counts_[InputRejection::kImuAhead];
  if (last_imu_ && sample.stamp <= *last_imu_) return rejection(InputRejection::kImuNotNewer);
  if (last_imu_ && !confirms && sample.stamp - *last_imu_ > max_step_) {
    unconfirmed_ = sample;
    return unexpected(InputRejection::kImuAhead);
  }
  last_imu_ = sample.stamp;
  if (confirms) return std::vector{*waiting, sample};
  return std::vector{sample};
}

expected<void, InputRejection> InputValidator::check_frame(Timestamp stamp) {
  if (!last_imu_ || stamp - *last_imu_ > max_step_) {
    return rejection(InputRejection::kFrameAheadOfImu);
  }
  if (last_frame_ && stamp <= *last_frame_) return rejection(InputRejection::kFrameNotNewer);
  last_frame_ = stamp;
  return {};
}

std::map<std::string, std::uint64_t> InputValidator::rejected() const {
  using enum InputRejection;
  std::map<std::string, std::uint64_t> rejected;
  for (const auto reason :
       {kImuNotNewer, kImuImpossible, kImuAhead, kFrameNotNewer, kFrameAheadOfImu}) {
    const auto found = counts_.find(reason);
    rejected.emplace(name(reason), found == counts_.end() ? 0 : found->second);
  }
  return rejected;
}

}  // namespace fleetloc
