#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "robot/cloud_client/localizer_stream.hpp"

namespace fleetloc {

/// The stream to the localizer that a session uses and, during a handover, the one to its
/// successor: a copy of the first that brings the successor all that the robot has, while the
/// first goes on. What is left is told.
class SessionStreams {
 public:
  using Time = LocalizerStream::Time;
  using Refusals = std::map<MessageRefusal, std::uint64_t>;
  struct Sent {
    bool to_current = false;
    bool to_successor = false;
  };

  SessionStreams(const RobotId& robot, Channel& channel, const LocalizerStream::Config& config)
      : current_(robot, channel, config) {}

  /// What a successor was brought is of the session before: it is dropped.
  void start_session(const RobotSession& session, Timestamp clock);
  /// The same, but the submaps so far are of the new session.
  void restart_session(const RobotSession& session, Timestamp clock);
  void update_start(const MapOdomEstimate& start);
  void add(Submap submap);

  /// From now on this localizer is used: if it is the successor, with all that it was brought.
  void use(const std::string& localizer, Incarnation incarnation, const Time& time);
  /// No localizer is used.
  void end(Timestamp clock);
  /// A localizer is to take over, in place of an earlier successor.
  void begin_successor(const std::string& localizer, Incarnation incarnation, const Time& time);
  /// It is told that it is not needed, if there is one.
  void drop_successor(Timestamp clock);

  Sent send_submaps(const Time& time);
  void repeat_announcements(const Time& time);
  /// This localizer does not know the session. Expects a stream to it.
  void announce_again_to(const std::string& localizer, const Time& time);
  /// Tells a localizer without a stream that it may be needed.
  void announce_to(const std::string& localizer, Timestamp clock);

  /// To the localizer in use, if there is one.
  [[nodiscard]] const LocalizerStream& current() const { return current_; }
  [[nodiscard]] bool is_successor(const std::string& localizer) const {
    return successor_ && localizer == successor_->localizer();
  }
  /// The successor's, if it is that; else the current one.
  [[nodiscard]] const LocalizerStream& of(const std::string& localizer) const {
    return is_successor(localizer) ? *successor_ : current_;
  }
  [[nodiscard]] const std::optional<LocalizerStream>& successor() const { return successor_; }
  /// An answer that passed the check of its stream.
  void answered(const LocalizationResult& answer, Timestamp now) {
    stream_of(answer.localizer).answered(answer, now);
  }
  /// How many messages could not be sent.
  [[nodiscard]] const Refusals& refusals() const { return refusals_; }

 private:
  LocalizerStream& stream_of(const std::string& localizer) {
    return is_successor(localizer) ? *successor_ : current_;
  }
  void hand_over(Timestamp clock);
  template <typename T>
  expected<T, MessageRefusal> count(expected<T, MessageRefusal> result) {
    if (!result) ++refusals_[result.error()];
    return result;
  }

  LocalizerStream current_;
  std::optional<LocalizerStream> successor_;
  Refusals refusals_;
};

}  // namespace fleetloc
