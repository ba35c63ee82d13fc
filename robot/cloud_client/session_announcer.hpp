#pragma once

#include <optional>
#include <string>

#include "shared/core/time.hpp"
#include "shared/model/session.hpp"

namespace fleetloc {

/// When the robot's session is announced, and with which start: with the newest one to a localizer
/// that does not know the session, then again, ever more rarely, until it answers. No I/O: it tells
/// what to send.
class SessionAnnouncer {
 public:
  struct Config {
    double interval_s;  ///< until the first answer; grows by a quarter each time
    double max_interval_s;
    double min_interval_s;  ///< however often the localizer asks for it
  };

  explicit SessionAnnouncer(const Config& config) : config_(config) {}

  /// A new session of the robot's odometry.
  void start(const RobotSession& session);

  /// For the next localizer that does not know the session.
  void update_start(const MapOdomEstimate& start) { newest_start_ = start; }

  /// Of the submaps that follow.
  void set_encoding(SubmapEncoding encoding) { session_->encoding = encoding; }

  /// The start cannot be encoded.
  void drop_start();

  /// The first announcement to this incarnation of a localizer. Expects a session.
  const RobotSession& announcement(const std::string& localizer,
                                   Incarnation incarnation,
                                   Timestamp now);

  /// The localizer has answered, so it knows the session.
  void answered() { is_answered_ = true; }

  /// The localizer does not know the session. What to send to it; nothing if the latest
  /// announcement has just been sent.
  std::optional<RobotSession> requested(Timestamp now);

  /// The latest announcement, if it is to be sent again now: it is lost if discovery had not yet
  /// matched the localizer's reader.
  std::optional<RobotSession> repetition(Timestamp now);

  /// As it was announced last.
  [[nodiscard]] const std::optional<RobotSession>& session() const { return session_; }

 private:
  void take_newest_start();

  Config config_;
  std::optional<RobotSession> session_;
  std::optional<MapOdomEstimate> newest_start_;
  bool is_answered_ = false;
  Timestamp announced_;
  double interval_s_ = 0.0;
};

}  // namespace fleetloc
