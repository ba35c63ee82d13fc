#include "shared/protocol/session_register.hpp"

#include <algorithm>

#include "shared/config/config_reader.hpp"

namespace fleetloc {
namespace {

constexpr std::size_t kMaxSuperseded = 4;

}  // namespace

std::string_view name(SessionRefusal refusal) {
  switch (refusal) {
    case SessionRefusal::kUnknown:
      return "unknown_session";
    case SessionRefusal::kOutdated:
      return "outdated_session";
    case SessionRefusal::kConflict:
      return "conflicting_session";
  }
  return "unknown";
}

SessionRegister::Acceptance SessionRegister::announced(const RobotSession& session, Timestamp now) {
  const Session announced{session.start_stamp, session.session};
  const auto known = robots_.find(session.robot);
  if (known == robots_.end()) {
    make_room();
    robots_[session.robot] = {
        .current = announced, .accepted = now, .heard = now, .superseded = {}};
    return {};
  }
  Robot& robot = known->second;
  if (announced == robot.current) {
    robot.heard = now;
    return {};
  }
  const bool wins =
      announced.is_later_than(robot.current) || to_seconds(now - robot.heard) > config_.silence_s;
  const Session superseded = wins ? robot.current : announced;
  if (std::ranges::find(robot.superseded, superseded) == robot.superseded.end())
    robot.superseded.push_back(superseded);
  if (robot.superseded.size() > kMaxSuperseded) robot.superseded.pop_front();
  if (!wins) return unexpected(refusal_of_superseded(robot, announced, now));
  std::erase(robot.superseded, announced);
  robot.current = announced;
  robot.accepted = now;
  robot.heard = now;
  return {};
}

SessionRegister::Acceptance SessionRegister::submap(const RobotId& id,
                                                    SessionNumber session,
                                                    Timestamp now) {
  const auto known = robots_.find(id);
  if (known == robots_.end()) return unexpected(SessionRefusal::kUnknown);
  Robot& robot = known->second;
  if (session == robot.current.number) {
    robot.heard = now;
    return {};
  }
  const auto superseded = std::ranges::find(robot.superseded, session, &Session::number);
  if (superseded == robot.superseded.end()) return unexpected(SessionRefusal::kUnknown);
  return unexpected(refusal_of_superseded(robot, *superseded, now));
}

SessionRegister::Acceptance SessionRegister::status(const RobotStatus& status, Timestamp now) {
  const auto known = robots_.find(status.robot);
  if (known == robots_.end()) return unexpected(SessionRefusal::kUnknown);
  Robot& robot = known->second;
  const Session session{status.start_stamp, status.session};
  if (session == robot.current) {
    robot.heard = now;
    return {};
  }
  if (session.is_later_than(robot.current)) return unexpected(SessionRefusal::kUnknown);
  return unexpected(refusal_of_superseded(robot, session, now));
}

// A session that its own robot has left by a reset of the odometry is no conflict.
SessionRefusal SessionRegister::refusal_of_superseded(const Robot& robot,
                                                      const Session& superseded,
                                                      Timestamp now) const {
  const bool settled = to_seconds(now - robot.accepted) > config_.settling_s;
  const bool other_robot = superseded.start_stamp != robot.current.start_stamp;
  return settled && other_robot ? SessionRefusal::kConflict : SessionRefusal::kOutdated;
}

void SessionRegister::make_room() {
  if (robots_.size() < config_.max_robots) return;
  robots_.erase(
      std::ranges::min_element(robots_, {}, [](const auto& item) { return item.second.heard; }));
}

SessionRegister::Config read_session_register_config(ConfigReader config) {
  return {.settling_s = config.positive("settling_s"),
          .silence_s = config.positive("silence_s"),
          .max_robots = static_cast<std::size_t>(config.integer("max_robots", 1, 1'000'000))};
}

}  // namespace fleetloc
