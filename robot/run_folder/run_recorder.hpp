#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "robot/cloud_client/cloud_client.hpp"
#include "robot/pipeline/robot_pipeline.hpp"
#include "robot/run_folder/run_folder.hpp"

namespace fleetloc {

/// Writes the outputs of a pipeline into a run folder. Without a map the traffic is zero.
class RunRecorder {
 public:
  explicit RunRecorder(const std::filesystem::path& folder) : folder_(folder) {}

  void write_config(const std::string& yaml) const { folder_.write_config(yaml); }
  void add_imu_rate_pose(const PoseEstimate& pose) { folder_.add_imu_rate_pose(pose); }
  void add_decoding(Duration cpu) { summary_.decode_ms.add(1e3 * to_seconds(cpu)); }

  /// Writes the pipeline's outputs since the last call.
  void record(RobotPipeline& pipeline, const CloudClient::Traffic& traffic);

  /// How the run ended, and what only the caller knows.
  struct End {
    bool interrupted = false;  ///< before the end of the dataset
    double wall_s = 0.0;
    std::map<std::string, std::uint64_t> input_faults;
  };
  /// Writes summary.json; processor time and memory are those of the process.
  void finish(const RobotPipeline& pipeline, const CloudClient::Traffic& traffic, const End& end);

 private:
  RunFolder folder_;
  RunSummary summary_;
};

}  // namespace fleetloc
