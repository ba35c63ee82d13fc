#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cloud/pool/admission.hpp"
#include "cloud/pool/answer_sender.hpp"
#include "cloud/pool/pool_refusal.hpp"
#include "cloud/pool/pool_report.hpp"
#include "shared/core/expected.hpp"
#include "shared/link/channel.hpp"
#include "shared/model/robot_status.hpp"
#include "shared/model/session.hpp"
#include "shared/model/submap.hpp"
#include "shared/protocol/session_register.hpp"
#include "shared/protocol/status_timer.hpp"

namespace fleetloc {

struct OutgoingMessage {
  std::string partition;  ///< the receiver, as in Channel::send
  Message message;
};

/// The localizer's end of the protocol: what it accepts from which robot, and what it sends.
/// Expects messages that are well-formed. A robot whose session is not known here is asked for it.
///
/// A localizer that is told to stop drains: it says so, takes no more robots, and answers those
/// that it has until they have gone to others.
class SessionProtocol {
 public:
  struct Draining {
    double max_s;                ///< then the robots that are left have to do without
    double silence_s;            ///< without a message of a robot, then it has left
    StatusTimer::Config status;  ///< meanwhile
  };
  struct Config {
    std::size_t max_sessions;
    double idle_session_s;  ///< without a message, then a session may be ended
    double session_request_interval_s;
    StatusTimer::Config status;
    AnswerSender::Config answers;
    SessionRegister::Config sessions;
    Admission::Config admission;
    Draining draining;
  };
  /// Of this localizer; stands in all that it sends.
  struct Identity {
    std::string name;
    Incarnation incarnation{};
    MapHash map_hash{};
  };
  /// What an announcement that was accepted means for the session of its robot here.
  enum class Change {
    kNone,
    kOpened,
    kReplaced,  ///< by a later one, of which nothing has arrived yet
    kNewStart,  ///< the same one, and its robot knows better where it started
    kLeft,      ///< the robot has gone to another localizer
  };

  SessionProtocol(Identity identity, const Config& config);

  /// That of a session with another localizer comes from a robot that leaves, or that may come when
  /// the other one fails. After kOpened, kReplaced and kNewStart answers
  /// to what came before are not sent any more. kLeft expects that the caller ends the session.
  expected<Change, PoolRefusal> announced(const RobotSession& session, Timestamp now);

  /// Accepted: it is new, and of the robot's session here, which is returned.
  expected<const RobotSession*, PoolRefusal> submap(const SubmapHeader& submap, Timestamp now);

  /// An accepted submap was found valid and is stored: it is acknowledged from now on.
  void store(const SubmapHeader& submap, Timestamp now);

  /// What the robot of a session here tells of its answers.
  void note(const RobotId& robot, const AnswerReceipt& receipt, Timestamp now);

  /// Of the network to the robot of a session here, there and back; zero as long as it is not
  /// known.
  [[nodiscard]] Duration round_trip(const RobotId& robot) const {
    return sessions_.at(robot).answers.budget().round_trip();
  }

  /// A status of a session that is not known here is refused without further consequences.
  expected<void, PoolRefusal> status(const RobotStatus& status, Timestamp now);

  /// The answer and the correction become the latest of the robot's session, with its identity.
  void answer(const RobotId& robot,
              LocalizationResult answer,
              std::optional<Correction> correction);

  /// New answers, repetitions, requests for sessions, and the localizer's status, when it has
  /// changed and from time to time.
  /// @param load    of the workers, 0..1
  /// @param report  counts answers that cannot be encoded
  std::vector<OutgoingMessage> outgoing(Timestamp now, double load, PoolReport& report);

  /// A job was started whose oldest submap has waited that long.
  void waited(Duration wait, Timestamp now) { admission_.waited(wait, now); }

  /// The localizer is about to end.
  void drain(Timestamp now);
  /// Robots that a draining localizer still has to answer; none once its time is over.
  [[nodiscard]] std::vector<RobotId> to_leave(Timestamp now) const;

  /// Ends the robot's session. @return when the robot was heard last
  Timestamp end(const RobotId& robot);

  /// Robots that have a session here and are silent.
  [[nodiscard]] std::vector<RobotId> idle(Timestamp now) const;

  /// Forgets robots whose session is unknown and that are silent. To be called from time to time.
  void clean_up(Timestamp now);

  /// Robots to which something will be sent, or may be soon, that have become known since the last
  /// call.
  std::vector<RobotId> take_expected();

  [[nodiscard]] std::size_t sessions() const { return sessions_.size(); }
  /// Of the localizer, as of the last outgoing().
  [[nodiscard]] const LocalizerStatus& localizer_status() const { return status_; }

 private:
  struct Session {
    RobotSession announced;
    SubmapReceiver receiver;
    AnswerSender answers;
    Timestamp opened;
    Timestamp last_message;
  };
  /// A robot that sends submaps of a session that is not known here.
  struct UnknownRobot {
    Timestamp requested;
    std::optional<LocalizationResult> unsent;
  };

  expected<Change, PoolRefusal> open(const RobotSession& session, Timestamp now);
  static Change adopt_newer_start(const RobotSession& session, Session& known);
  void request_session(const SubmapHeader& submap, Timestamp now);
  void add_answers(std::vector<OutgoingMessage>& messages, Timestamp now, PoolReport& report);
  void add_session_requests(std::vector<OutgoingMessage>& messages);
  LocalizerStatus measured_status(double load, Timestamp now);

  Identity identity_;
  Config config_;
  SessionRegister register_;
  std::map<RobotId, Session> sessions_;
  std::uint32_t last_number_ = 0;  // of an answer in any session that has ended
  std::map<RobotId, UnknownRobot> unknown_robots_;
  std::vector<RobotId> expected_;
  Admission admission_;
  std::optional<Timestamp> draining_since_;
  StatusTimer status_timer_;
  LocalizerStatus status_, sent_status_;
};

SessionProtocol::Config read_session_protocol_config(ConfigReader pool);

}  // namespace fleetloc
