#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "cloud/pool/pool_refusal.hpp"
#include "cloud/pool/session_report.hpp"
#include "shared/core/ids.hpp"
#include "shared/core/time.hpp"
#include "shared/wire/malformed.hpp"

namespace fleetloc {

/// What a localizer has to say of its robots: statistics of those that are served and of the latest
/// that were, counts of messages of all others, and events for the log. Bounded in memory.
class PoolReport {
 public:
  /// @param max_departed  robots that are no longer served and still reported
  explicit PoolReport(std::size_t max_departed) : max_departed_(max_departed) {}

  /// The robot is served from now on; what is known of it from earlier is continued.
  void open(const RobotId& robot);

  /// The robot is no longer served.
  void close(const RobotId& robot, const std::string& why, Timestamp last_message);

  /// Of a robot that is served.
  SessionReport& of(const RobotId& robot) { return served_.at(robot); }

  /// A message or work of a robot that is not used. A conflict becomes an event once, until it is
  /// over.
  void refuse(const RobotId& robot, PoolRefusal refusal, Timestamp now);

  /// A message that is not well-formed: its robot is not known.
  void refuse(Malformed reason) { ++unattributed_[std::string(name(reason))]; }

  void log(std::string event);

  /// Forgets conflicts that are over. To be called from time to time.
  void clean_up(Timestamp now);

  /// Events since the last call, each a line for the log.
  std::vector<std::string> take_events();

  [[nodiscard]] std::map<RobotId, SessionReport> reports() const;
  /// Messages of robots that are not served, by reason.
  [[nodiscard]] const std::map<std::string, std::uint64_t>& unattributed() const {
    return unattributed_;
  }

 private:
  struct Departed {
    Timestamp last_message;
    SessionReport report;
  };

  void note_conflict(const RobotId& robot, const std::string& what, Timestamp now);

  std::size_t max_departed_;
  std::map<RobotId, SessionReport> served_;
  std::map<RobotId, Departed> departed_;
  std::map<RobotId, Timestamp> conflicts_;  // when the refused robot was heard last
  std::map<std::string, std::uint64_t> unattributed_;
  std::vector<std::string> events_;
};

}  // namespace fleetloc
