#include "robot/cloud_client/session_announcer.hpp"

#include <algorithm>

namespace fleetloc {
namespace {

constexpr double kGrowth = 1.25;

}  // namespace

void SessionAnnouncer::start(const RobotSession& session) {
  session_ = session;
  newest_start_ = session.start;
}

void SessionAnnouncer::drop_start() {
  session_->start.reset();
  newest_start_.reset();
}

const RobotSession& SessionAnnouncer::announcement(const std::string& localizer,
                                                   Incarnation incarnation,
                                                   Timestamp now) {
  is_answered_ = false;
  interval_s_ = config_.interval_s;
  announced_ = now;
  session_->localizer = localizer;
  session_->incarnation = incarnation;
  take_newest_start();
  return *session_;
}

std::optional<RobotSession> SessionAnnouncer::requested(Timestamp now) {
  is_answered_ = false;
  interval_s_ = config_.interval_s;
  if (to_seconds(now - announced_) < config_.min_interval_s) return std::nullopt;
  announced_ = now;
  take_newest_start();
  return session_;
}

// Where the robot began is of no use to those who know where it is.
void SessionAnnouncer::take_newest_start() {
  session_->start = newest_start_;
  if (session_->start) session_->region.reset();
}

// With the same start: another one would make the localizer restart the session.
std::optional<RobotSession> SessionAnnouncer::repetition(Timestamp now) {
  if (!session_ || is_answered_ || to_seconds(now - announced_) < interval_s_) return std::nullopt;
  interval_s_ = std::min(kGrowth * interval_s_, config_.max_interval_s);
  announced_ = now;
  return session_;
}

}  // namespace fleetloc
