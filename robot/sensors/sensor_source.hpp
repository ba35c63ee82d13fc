#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <variant>

#include "robot/sensors/clock_step.hpp"
#include "robot/sensors/given_pose.hpp"
#include "shared/model/camera_frame.hpp"
#include "shared/model/inertial.hpp"

namespace fleetloc {

/// One measurement, or where somebody says that the robot is, or that the clock of all that follow
/// was set.
using SensorMeasurement = std::variant<ImuSample, CameraFrame, GivenPose, ClockStep>;

inline Timestamp stamp_of(const SensorMeasurement& measurement) {
  if (const auto* sample = std::get_if<ImuSample>(&measurement)) return sample->stamp;
  if (const auto* given = std::get_if<GivenPose>(&measurement)) return given->stamp;
  if (const auto* step = std::get_if<ClockStep>(&measurement)) return step->stamp;
  return stamp_of(std::get<CameraFrame>(measurement));
}

/// Where a robot's measurements come from, whatever is behind it: a recording, the same recording
/// with faults or in real time, a simulation, live topics. One thread at a time.
class SensorSource {
 public:
  SensorSource() = default;
  virtual ~SensorSource() = default;
  SensorSource(const SensorSource&) = delete;
  SensorSource& operator=(const SensorSource&) = delete;

  /// The next measurement; waits for it if need be. Nothing at the end, or when a stop is
  /// requested. Throws std::runtime_error if the source fails.
  virtual std::optional<SensorMeasurement> next(const std::stop_token& stop) = 0;
  std::optional<SensorMeasurement> next() { return next({}); }

  /// Frames in all, if that is known.
  [[nodiscard]] virtual std::optional<std::size_t> frame_count() const = 0;

  /// Ends the reading: there is no call of next() after it.
  /// @return recoverable faults of the input so far, by kind, e.g. "dropped_frames"
  virtual std::map<std::string, std::uint64_t> close() = 0;
};

}  // namespace fleetloc
