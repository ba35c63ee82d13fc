#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cloud/laser_map/laser_map.hpp"
#include "cloud/localizer/session_localizer.hpp"
#include "cloud/pool/pool_refusal.hpp"
#include "cloud/pool/session_report.hpp"
#include "shared/link/channel.hpp"
#include "shared/model/session.hpp"
#include "shared/protocol/retransmission_timer.hpp"
#include "shared/protocol/session_register.hpp"
#include "shared/protocol/submap_receiver.hpp"

namespace fleetloc {

class ConfigReader;

/// The localizer's end of the protocol, for many robots: validates what arrives, keeps a session
/// per robot, hands out the localizations that are due, and the messages to send. It owns no thread
/// and reads no clock: jobs may run on any thread, one at a time for each robot; everything else is
/// one thread's.
///
/// Fair scheduling: worker time is shared evenly among the robots that wait, whatever their jobs
/// take. The memory of a robot is bounded, and freed when it has been silent for long.
class LocalizerPool {
 public:
  struct Config {
    SessionLocalizer::Config localizer;
    std::size_t max_sessions;
    std::size_t max_session_bytes;  ///< of one robot's localizer; beyond, its session is restarted
    std::size_t max_waiting_submaps;
    std::size_t max_waiting_bytes;  ///< of one robot's waiting submaps, as received
    double max_waiting_s;           ///< older submaps are dropped
    double idle_session_s;          ///< without a message, then the session is ended
    double session_request_interval_s;
    double status_interval_s;
    RetransmissionTimer::Config retransmission;
    SessionRegister::Config sessions;
  };

  /// One localization: everything that has arrived of one robot since its last one.
  struct Job {
    RobotId robot;
    Timestamp received;  ///< the oldest of the submaps
    Timestamp started;
    std::shared_ptr<SessionLocalizer> session;
    std::vector<Submap> submaps;
    std::optional<Correction> correction;  ///< what run() found beside the answer
    std::string error;                     ///< why run() failed; empty: it did not
  };

  struct Outgoing {
    std::string partition;
    Message message;
  };

  LocalizerPool(std::string name,
                Incarnation incarnation,
                std::shared_ptr<const LaserMap> map,
                const Config& config);

  void receive(const Message& message, Timestamp now);

  /// A job of the robot that has used the least worker time, of those that wait and have none
  /// running.
  std::optional<Job> take_job(Timestamp now);

  /// Does the work of a job. Static, since it may run beside everything else.
  static LocalizationResult run(Job& job);

  /// Takes the result over. `optimize_ms` is only reported.
  void finish(const Job& job, LocalizationResult answer, double optimize_ms, Timestamp now);

  /// New answers, repetitions, and from time to time the localizer's own status.
  std::vector<Outgoing> outgoing(Timestamp now, double load);

  /// Robots that have stopped being served since the last call: their partitions need no writers.
  std::vector<RobotId> take_departed();
  /// Events since the last call, each a line for the log.
  std::vector<std::string> take_events();

  /// Of the robots that are served, and of the latest that were.
  [[nodiscard]] std::map<RobotId, SessionReport> reports() const;
  /// Messages of robots that are not served, by reason.
  [[nodiscard]] const std::map<std::string, std::uint64_t>& unattributed() const {
    return unattributed_;
  }
  [[nodiscard]] std::size_t sessions() const { return robots_.size(); }

 private:
  struct Waiting {
    Submap submap;
    Timestamp received;
    std::size_t bytes{};
  };
  struct Robot {
    explicit Robot(const RetransmissionTimer::Config& config) : retransmission(config) {}

    std::optional<RobotSession> session;
    std::shared_ptr<SessionLocalizer> localizer;
    std::shared_ptr<SessionLocalizer> running;  // that of the job that is being worked on
    SubmapReceiver receiver;
    std::deque<Waiting> waiting;
    std::size_t waiting_bytes = 0;
    Timestamp last_message;
    Duration used{};  // virtual time: worker time that it has used
    std::optional<LocalizationResult>
        answer;  // the latest, with the acknowledgements when it was made
    bool unsent = false;
    std::optional<Correction> correction;  // of that answer, until it is sent
    RetransmissionTimer retransmission;
    SessionReport report;
  };
  /// A robot that sends submaps of a session that is not known here.
  struct UnknownRobot {
    Timestamp requested;
    std::optional<LocalizationResult> unsent;
  };
  /// A robot that is no longer served.
  struct DepartedRobot {
    Timestamp last_message;
    SessionReport report;
  };

  void receive_session(const Bytes& payload, Timestamp now);
  void receive_submap(const Bytes& payload, Timestamp now);
  void receive_robot_status(const Bytes& payload, Timestamp now);
  void open(RobotSession session, Timestamp now);
  void restart_session(Robot& robot, RobotSession session);
  void adopt_newer_start(Robot& robot, RobotSession session);
  void store(Robot& robot, Submap submap, std::size_t bytes, Timestamp now);
  void request_session(const Submap& submap, Timestamp now);
  void end(const RobotId& robot, const std::string& why);
  void remove_expired(Timestamp now);
  void drop_stale_work(Robot& robot, Timestamp now) const;
  static void pop_waiting(Robot& robot);
  /// Counts a message of a robot, served or not, that is not used.
  template <typename Reason>
  void refuse(const RobotId& robot, Reason reason) {
    const auto found = robots_.find(robot);
    auto& counts = found != robots_.end() ? found->second.report.refused : unattributed_;
    ++counts[std::string(name(reason))];
  }
  void refuse_superseded(const RobotId& robot, SessionRefusal refusal, Timestamp now);
  void log_event(std::string event);
  void send_correction(const RobotId& id, Robot& robot, std::vector<Outgoing>& messages);
  void add_answers(std::vector<Outgoing>& messages, Timestamp now);
  void add_session_requests(std::vector<Outgoing>& messages);
  [[nodiscard]] LocalizerStatus status(double load) const;

  std::string name_;
  Incarnation incarnation_;
  std::shared_ptr<const LaserMap> map_;
  Config config_;
  SessionRegister register_;
  std::map<RobotId, Robot> robots_;
  std::map<RobotId, UnknownRobot> unknown_robots_;
  std::map<RobotId, DepartedRobot> departed_robots_;
  std::map<RobotId, Timestamp> conflicts_;  // when last reported
  Duration virtual_time_{};                 // of the robot that was served last
  std::map<std::string, std::uint64_t> unattributed_;
  std::vector<RobotId> departed_;
  std::vector<std::string> events_;
  std::optional<Timestamp> status_sent_;
  std::optional<Timestamp> last_cleanup_;
};

LocalizerPool::Config read_localizer_pool_config(ConfigReader config);

}  // namespace fleetloc
