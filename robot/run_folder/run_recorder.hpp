#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "robot/run_folder/run_folder.hpp"
#include "robot/runtime/robot_sink.hpp"

namespace fleetloc {

/// Writes what comes out of a robot into a run folder.
class RunRecorder final : public RobotSink {
 public:
  explicit RunRecorder(const std::filesystem::path& folder, const RunParts& parts = {})
      : folder_(folder, parts) {}

  void write_config(const std::string& yaml) const { folder_.write_config(yaml); }

  /// What follows is a new part of the folder.
  void begin_part() { is_new_part_ = true; }

  void add(const RobotOutput& output) override;

  /// "unwritten_outputs": since the disk failed, which ends the recording and not the robot.
  [[nodiscard]] std::map<std::string, std::uint64_t> faults() const override;

  /// Writes summary.json; processor time and memory are those of the process.
  void finish(const RunEnd& end) override;

 private:
  void write(const RobotOutput& output);

  RunFolder folder_;
  Histogram tracking_ms_;
  bool is_new_part_ = false;  // with the next output
  std::uint64_t unwritten_ = 0;
};

}  // namespace fleetloc
