#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

#include "robot/cloud_client/message_refusal.hpp"
#include "robot/cloud_client/session_announcer.hpp"
#include "robot/uplink/submap_uplink.hpp"
#include "shared/core/expected.hpp"
#include "shared/link/channel.hpp"
#include "shared/model/localization_result.hpp"
#include "shared/protocol/submap_receiver.hpp"

namespace fleetloc {

/// What a robot exchanges with one incarnation of one localizer: it announces its session until
/// that answers, sends submaps, and tells which answers are of them. A copy of it that begins with
/// another localizer brings that all that the robot has.
class LocalizerStream {
 public:
  struct Config {
    SessionAnnouncer::Config announcement;
    SubmapUplink::Config uplink;
  };
  struct Time {
    Timestamp now;    ///< of the timers: SteadyTime
    Timestamp clock;  ///< of the robot, for the channel; may be set meanwhile
  };

  LocalizerStream(const RobotId& robot, Channel& channel, const Config& config)
      : robot_(robot),
        channel_(&channel),
        announcer_(config.announcement),
        uplink_(robot, config.uplink) {}

  /// A new session of the robot's odometry; it is announced from begin() on.
  void start_session(const RobotSession& session);
  /// The same, but the submaps so far are of the new session.
  void restart_session(const RobotSession& session);
  [[nodiscard]] bool has_session() const { return announcer_.session().has_value(); }
  /// As it was announced last. Expects one.
  [[nodiscard]] const RobotSession& session() const { return *announcer_.session(); }

  /// For the next localizer that does not know the session.
  void update_start(const MapOdomEstimate& start) { announcer_.update_start(start); }
  void add(Submap submap) { uplink_.add(std::move(submap)); }

  /// From now on this localizer is told everything, the session first.
  /// @return kNotEncodable: the start pose was left out
  expected<void, MessageRefusal> begin(const std::string& localizer,
                                       Incarnation incarnation,
                                       const Time& time);
  void end() { localizer_.clear(); }
  /// The next begin() uses no sample number of that stream again, which is of the same session: the
  /// localizer may remember it.
  void note_numbers_of(const LocalizerStream& other) {
    used_numbers_ = std::max({used_numbers_, other.used_numbers_, other.uplink_.sender().sent()});
  }

  /// Announces the session again, if that is due.
  expected<void, MessageRefusal> repeat_announcement(const Time& time);
  /// @return whether a submap was due and was sent
  expected<bool, MessageRefusal> send_submap(const Time& time);

  /// Tells another localizer of the session as it is here: that it is left for this one, or that it
  /// may be needed.
  expected<void, MessageRefusal> announce_to(const std::string& localizer, Timestamp clock);

  /// Whether the answer is of this localizer and this session.
  [[nodiscard]] expected<void, MessageRefusal> check(const LocalizationResult& answer) const;

  /// An answer that passed check().
  void answered(const LocalizationResult& answer, Timestamp now);
  /// The localizer does not know the session: it has dropped it or never received it, and has
  /// nothing of it.
  expected<void, MessageRefusal> requested(const Time& time);

  [[nodiscard]] const std::string& localizer() const { return localizer_; }  ///< empty: none
  [[nodiscard]] Incarnation incarnation() const { return incarnation_; }
  [[nodiscard]] const SubmapUplink& uplink() const { return uplink_; }

 private:
  expected<void, MessageRefusal> announce(const RobotSession& session, Timestamp clock) {
    return announce(session, localizer_, clock);
  }
  expected<void, MessageRefusal> announce(const RobotSession& session,
                                          const std::string& to,
                                          Timestamp clock);

  RobotId robot_;
  Channel* channel_;
  std::string localizer_;
  Incarnation incarnation_{};
  SessionAnnouncer announcer_;
  SubmapUplink uplink_;
  std::uint32_t used_numbers_ = 0;  // below it, in other streams of this session
  SubmapReceiver answers_;          // by their numbers
  AnswerReceipt receipt_;           // what the localizer is told of them
};

}  // namespace fleetloc
