#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <string_view>
#include <tuple>

#include "shared/core/expected.hpp"
#include "shared/core/ids.hpp"
#include "shared/core/time.hpp"
#include "shared/model/robot_status.hpp"
#include "shared/model/session.hpp"

namespace fleetloc {

class ConfigReader;

/// Why a message is not of the current session of its robot.
enum class SessionRefusal {
  kUnknown,   ///< of a session that was never announced, or whose announcement was lost
  kOutdated,  ///< of a session that was replaced: an old datagram
  kConflict,  ///< the same, but still active: two robots have one id
};

/// Name in logs and sessions.json, e.g. "conflicting_session".
std::string_view name(SessionRefusal refusal);

/// The current session of each robot. A later start of the program wins, and within one run of the
/// program the higher session number: a restarted robot is accepted at once, and an old datagram
/// restores nothing. Messages of a superseded session after `settling_s` are a conflict. A session
/// that is silent for `silence_s` is replaced by any other: the robot's clock may have been set
/// back.
///
/// Each localizer has its own, and knows what it is told: by the robots that it serves, that leave
/// it, and that may come. Two robots with one id that use different localizers are noticed by
/// themselves: they hear each other's answers.
class SessionRegister {
 public:
  struct Config {
    double settling_s;       ///< after a replacement: datagrams of the old session may arrive
    double silence_s;        ///< then any other session replaces the current one
    std::size_t max_robots;  ///< beyond it, the least recently heard one is dropped
  };

  explicit SessionRegister(const Config& config) : config_(config) {}

  using Acceptance = expected<void, SessionRefusal>;

  /// Accepted: it is the current session now. Never kUnknown.
  Acceptance announced(const RobotSession& session, Timestamp now);
  Acceptance submap(const RobotId& id, SessionNumber session, Timestamp now);
  Acceptance status(const RobotStatus& status, Timestamp now);

  [[nodiscard]] std::size_t robots() const { return robots_.size(); }

 private:
  struct Session {
    Timestamp start_stamp;
    SessionNumber number{};
    bool operator==(const Session& other) const = default;
    [[nodiscard]] bool is_later_than(const Session& other) const {
      return std::tie(start_stamp, number) > std::tie(other.start_stamp, other.number);
    }
  };
  struct Robot {
    Session current;
    Timestamp accepted;
    Timestamp heard;
    std::deque<Session> superseded;  // the latest
  };

  void make_room();
  [[nodiscard]] SessionRefusal refusal_of_superseded(const Robot& robot,
                                                     const Session& superseded,
                                                     Timestamp now) const;

  Config config_;
  std::map<RobotId, Robot> robots_;
};

SessionRegister::Config read_session_register_config(ConfigReader config);

}  // namespace fleetloc
