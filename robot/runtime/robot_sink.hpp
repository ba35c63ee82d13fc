#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "robot/pipeline/robot_pipeline.hpp"
#include "shared/core/histogram.hpp"
#include "shared/model/map_localizer.hpp"
#include "shared/model/pose_estimate.hpp"

namespace fleetloc {

/// What came out of the robot with one IMU sample.
struct RobotOutput {
  std::optional<PoseEstimate> pose;  ///< at the sample; nothing after the last one
  std::vector<FrameOutput> frames;
  std::vector<LocalizationOutput> answers;
  LinkTraffic traffic;  ///< so far
};

/// How a run ended.
struct RunEnd {
  const RobotPipeline& robot;
  LinkTraffic traffic;
  bool interrupted = false;  ///< by a signal or an error, before the end of the input
  double wall_s = 0.0;
  Histogram decode_ms;                          ///< processor time, of each pair of images
  std::map<std::string, std::uint64_t> faults;  ///< of sensors and sinks, by kind
};

/// Takes what comes out of a robot: a publisher, the writer of a run folder, a log.
class RobotSink {
 public:
  RobotSink() = default;
  virtual ~RobotSink() = default;
  RobotSink(const RobotSink&) = delete;
  RobotSink& operator=(const RobotSink&) = delete;

  virtual void add(const RobotOutput& output) = 0;

  /// Outputs that it could not use so far, by kind.
  [[nodiscard]] virtual std::map<std::string, std::uint64_t> faults() const { return {}; }

  /// Once, after the last add().
  virtual void finish(const RunEnd& /*end*/) {}
};

}  // namespace fleetloc
