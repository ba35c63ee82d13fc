#include "robot/cloud_client/localizer_stream.hpp"

#include <algorithm>

#include "shared/wire/malformed.hpp"
#include "shared/wire/session_codec.hpp"

namespace fleetloc {

using enum MessageRefusal;

void LocalizerStream::start_session(const RobotSession& session) {
  uplink_.start_session(session.stereo);
  restart_session(session);
}

void LocalizerStream::restart_session(const RobotSession& session) {
  announcer_.start(session);
  announcer_.set_encoding(uplink_.encoding());
  used_numbers_ = 0;
}

expected<void, MessageRefusal> LocalizerStream::begin(const std::string& localizer,
                                                      Incarnation incarnation,
                                                      const Time& time) {
  localizer_ = localizer;
  incarnation_ = incarnation;
  if (!has_session()) return {};
  answers_ = {};
  receipt_ = {};
  uplink_.restart(session().session, incarnation, used_numbers_);
  return announce(announcer_.announcement(localizer, incarnation, time.now), time.clock);
}

expected<void, MessageRefusal> LocalizerStream::repeat_announcement(const Time& time) {
  if (localizer_.empty()) return {};
  const auto repetition = announcer_.repetition(time.now);
  if (!repetition) return {};
  return announce(*repetition, time.clock);
}

expected<bool, MessageRefusal> LocalizerStream::send_submap(const Time& time) {
  if (localizer_.empty() || !has_session()) return false;
  try {
    if (receipt_.newest != 0) receipt_.age = answers_.since_newest(time.now);
    auto message = uplink_.next(receipt_, time.now);
    if (!message) return false;
    channel_->send(localizer_, *std::move(message), time.clock);
    return true;
  } catch (const NotEncodable&) {  // out of range of the wire type; the next one may fit
    return unexpected(kNotEncodable);
  }
}

expected<void, MessageRefusal> LocalizerStream::announce_to(const std::string& localizer,
                                                            Timestamp clock) {
  return announce(session(), localizer, clock);
}

expected<void, MessageRefusal> LocalizerStream::announce(const RobotSession& session,
                                                         const std::string& to,
                                                         Timestamp clock) {
  try {
    channel_->send(to, {Topic::kSession, encode(session)}, clock);
    return {};
  } catch (const NotEncodable&) {  // start out of range of the wire type
    announcer_.drop_start();
    return unexpected(kNotEncodable);
  }
}

expected<void, MessageRefusal> LocalizerStream::check(const LocalizationResult& answer) const {
  if (answer.robot != robot_ || !has_session() || answer.session != session().session) {
    return unexpected(kOtherSession);
  }
  if (answer.localizer != localizer_) return unexpected(kOtherLocalizer);
  const bool asks = answer.status == LocalizationStatus::kNeedFull;
  if (asks && !uplink_.sender().awaits(answer.keyframe)) return unexpected(kNotAsked);
  if (answer.incarnation < incarnation_ || (!asks && answer.incarnation != incarnation_)) {
    return unexpected(kOtherIncarnation);
  }
  return {};
}

// Answers are numbered by the incarnation of a localizer.
void LocalizerStream::answered(const LocalizationResult& answer, Timestamp now) {
  announcer_.answered();
  uplink_.acknowledge(answer, now);
  const SampleNumber number{answer.number};
  if (!answers_.is_new(number)) return;
  answers_.store(number, now);
  receipt_.newest = std::max(receipt_.newest, answer.number);
  receipt_.loss = answers_.expected_loss();
}

expected<void, MessageRefusal> LocalizerStream::requested(const Time& time) {
  uplink_.forget_deliveries();
  const auto announcement = announcer_.requested(time.now);
  if (!announcement) return {};
  return announce(*announcement, time.clock);
}

}  // namespace fleetloc
