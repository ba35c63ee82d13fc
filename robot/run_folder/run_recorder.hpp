#pragma once

#include <string>

#include "robot/run_folder/run_folder.hpp"
#include "robot/runtime/robot_sink.hpp"

namespace fleetloc {

/// Writes what comes out of a robot into a run folder.
class RunRecorder final : public RobotSink {
 public:
  explicit RunRecorder(const std::filesystem::path& folder) : folder_(folder) {}

  void write_config(const std::string& yaml) const { folder_.write_config(yaml); }

  void add(const RobotOutput& output) override;

  /// Writes summary.json; processor time and memory are those of the process.
  void finish(const RunEnd& end) override;

 private:
  RunFolder folder_;
  Histogram tracking_ms_;
};

}  // namespace fleetloc
