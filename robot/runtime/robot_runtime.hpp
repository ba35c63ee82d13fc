#pragma once

#include <chrono>
#include <cstddef>
#include <exception>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "robot/pipeline/robot_pipeline.hpp"
#include "robot/runtime/robot_sink.hpp"
#include "robot/sensors/sensor_source.hpp"
#include "shared/config/progress_line.hpp"

namespace fleetloc {

/// Runs a robot: measurements from a SensorSource go into the pipeline, its outputs to the sinks.
/// The same loop on a robot and in a replay; what differs is plugged in. One thread.
class RobotRuntime {
 public:
  /// All must outlive the runtime.
  /// @param name  of the robot, beside the progress
  RobotRuntime(const std::string& name,
               SensorSource& sensors,
               RobotPipeline& robot,
               std::vector<std::reference_wrapper<RobotSink>> sinks);

  /// Once, until the sensors end or a stop is requested. Every sink is finished, whatever ends it;
  /// the first exception of sensors, pipeline or sinks is passed on then.
  void run(const std::stop_token& stop);

 private:
  void take(SensorMeasurement measurement);
  void add(CameraFrame frame);
  void add(const ImuSample& sample);
  void deliver(const std::optional<PoseEstimate>& pose);
  void finish(double wall_s, bool interrupted, std::exception_ptr failure);

  SensorSource& sensors_;
  RobotPipeline& robot_;
  std::vector<std::reference_wrapper<RobotSink>> sinks_;
  std::optional<ProgressLine> progress_;  // while it runs
  std::size_t frames_ = 0;
  Histogram decode_ms_;
};

}  // namespace fleetloc
