#pragma once

#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "robot/runtime/robot_sink.hpp"
#include "shared/core/ids.hpp"

namespace fleetloc {

/// Of a last pose: the robot may have been pushed meanwhile.
struct LastPoseSigma {
  double position_sigma_m = 0.0;
  double yaw_sigma_rad = 0.0;
};

/// Where a robot was when its program ended, from a file of LastPoseFile. Nothing, with a warning
/// in the log, if the file is damaged or is another robot's.
std::optional<Pose> read_last_pose(const std::filesystem::path& file, const RobotId& robot);

/// Keeps the robot's pose in the map in a small file that survives a reboot: for the next start, a
/// hypothesis. Written while it is localized, by a thread of its own since disks are slow, at most
/// every two seconds and not while it stands still; as a whole, or not at all.
class LastPoseFile final : public RobotSink {
 public:
  LastPoseFile(std::filesystem::path file, RobotId robot);
  ~LastPoseFile() override;
  LastPoseFile(const LastPoseFile&) = delete;
  LastPoseFile& operator=(const LastPoseFile&) = delete;

  void add(const RobotOutput& output) override;

 private:
  void write_poses(const std::stop_token& stop);

  std::filesystem::path file_;
  RobotId robot_;
  std::optional<Pose> given_;  // to the thread, last

  std::mutex mutex_;
  std::condition_variable_any is_new_;
  std::optional<Pose> newest_;  // to be written
  std::jthread thread_;         // last: uses the others
};

}  // namespace fleetloc
