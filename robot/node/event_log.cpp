#include "robot/node/event_log.hpp"

#include <spdlog/spdlog.h>

namespace fleetloc {

void EventLog::add(const RobotOutput& output) {
  frames_ += output.frames.size();
  for (const std::string& event : channel_.take_events()) spdlog::info("{}: {}", robot_, event);
  for (const std::string& event : client_.take_events()) spdlog::info("{}: {}", robot_, event);
  for (const std::string& event : state_.add(output)) spdlog::info("{}: {}", robot_, event);
}

void EventLog::finish(const RunEnd& end) {
  const OdometryStatistics& odometry = end.robot.odometry().statistics();
  const CloudClient::Statistics statistics = client_.statistics();
  spdlog::info("{}: {} frames, {} keyframes, {} submaps sent, {} answers from {}",
               robot_,
               frames_,
               odometry.keyframes,
               statistics.submaps_sent,
               statistics.answers_received,
               statistics.localizer.empty() ? "no localizer" : statistics.localizer);
  for (const auto& faults : {end.faults, end.robot.faults()}) {
    for (const auto& [kind, count] : faults) {
      if (count > 0) spdlog::warn("{}: {} times {}", robot_, count, kind);
    }
  }
  for (const auto& [reason, count] : statistics.refused) {
    spdlog::warn("{}: {} messages not used: {}", robot_, count, reason);
  }
}

}  // namespace fleetloc
