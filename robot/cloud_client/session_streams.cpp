#include "robot/cloud_client/session_streams.hpp"

#include <utility>

namespace fleetloc {

void SessionStreams::start_session(const RobotSession& session, Timestamp clock) {
  drop_successor(clock);
  current_.start_session(session);
}

void SessionStreams::restart_session(const RobotSession& session, Timestamp clock) {
  drop_successor(clock);
  current_.restart_session(session);
}

void SessionStreams::update_start(const MapOdomEstimate& start) {
  current_.update_start(start);
  if (successor_) successor_->update_start(start);
}

void SessionStreams::add(Submap submap) {
  if (successor_) successor_->add(submap);
  current_.add(std::move(submap));
}

void SessionStreams::use(const std::string& localizer, Incarnation incarnation, const Time& time) {
  if (is_successor(localizer)) return hand_over(time.clock);
  drop_successor(time.clock);
  const std::string left = current_.localizer();
  count(current_.begin(localizer, incarnation, time));
  if (!left.empty() && left != localizer) announce_to(left, time.clock);
}

// The one that is left is told and ends the session at once.
void SessionStreams::hand_over(Timestamp clock) {
  const std::string left = current_.localizer();
  successor_->note_numbers_of(current_);
  current_ = *std::exchange(successor_, std::nullopt);
  announce_to(left, clock);
}

void SessionStreams::end(Timestamp clock) {
  drop_successor(clock);
  current_.end();
}

void SessionStreams::begin_successor(const std::string& localizer,
                                     Incarnation incarnation,
                                     const Time& time) {
  drop_successor(time.clock);
  successor_ = current_;
  count(successor_->begin(localizer, incarnation, time));
}

void SessionStreams::drop_successor(Timestamp clock) {
  if (!successor_) return;
  if (!current_.localizer().empty()) announce_to(successor_->localizer(), clock);
  current_.note_numbers_of(*successor_);
  successor_.reset();
}

SessionStreams::Sent SessionStreams::send_submaps(const Time& time) {
  return {.to_current = count(current_.send_submap(time)).value_or(false),
          .to_successor = successor_ && count(successor_->send_submap(time)).value_or(false)};
}

void SessionStreams::repeat_announcements(const Time& time) {
  count(current_.repeat_announcement(time));
  if (successor_) count(successor_->repeat_announcement(time));
}

void SessionStreams::announce_again_to(const std::string& localizer, const Time& time) {
  count(stream_of(localizer).requested(time));
}

void SessionStreams::announce_to(const std::string& localizer, Timestamp clock) {
  count(current_.announce_to(localizer, clock));
}

}  // namespace fleetloc
