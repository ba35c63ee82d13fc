#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "robot/runtime/robot_sink.hpp"
#include "shared/ros2/diagnostics_codec.hpp"
#include "shared/transport/ros2/ros2_participant.hpp"

namespace fleetloc {

/// What is known of the sensors beside what they measure.
struct SensorState {
  std::vector<std::string> silent_topics;
  std::map<std::string, std::uint64_t> faults;
};

/// What a robot has last come to know.
struct RobotState {
  std::optional<PoseEstimate> pose;
  std::optional<LocalizationOutput> answer;
  LinkTraffic traffic;
};

/// A robot as diagnostic_msgs/DiagnosticStatus says it: its localization, its sensors, its link.
std::vector<DiagnosticStatus> robot_diagnostics(const std::string& robot,
                                                const RobotState& state,
                                                const SensorState& sensors);

/// Publishes diagnostic_msgs/DiagnosticArray on /diagnostics each second, whether or not the
/// sensors give anything: its thread tells the silence, too.
class Ros2Diagnostics final : public RobotSink {
 public:
  /// Throws TransportError.
  /// @param participant  outlives this
  /// @param sensors  is asked by the thread
  Ros2Diagnostics(std::string robot,
                  Ros2Participant& participant,
                  std::function<SensorState()> sensors);

  void add(const RobotOutput& output) override;

 private:
  void publish(const std::stop_token& stop);
  [[nodiscard]] Bytes message() const;

  std::string robot_;
  std::function<SensorState()> sensors_;
  Ros2Writer writer_;  // used by the thread only
  mutable std::mutex mutex_;
  RobotState state_;     // guarded by mutex_
  std::jthread thread_;  // last: uses the others
};

}  // namespace fleetloc
