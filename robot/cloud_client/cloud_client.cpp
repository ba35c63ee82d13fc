#include "robot/cloud_client/cloud_client.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "shared/config/config_reader.hpp"
#include "shared/wire/correction_codec.hpp"
#include "shared/wire/localization_result_codec.hpp"
#include "shared/wire/session_codec.hpp"
#include "shared/wire/status_codec.hpp"
#include "shared/wire/submap_codec.hpp"

namespace fleetloc {
namespace {

constexpr std::size_t kMaxEvents = 100;  // further ones are dropped

// Answers with equal identity are repetitions.
auto identity(const LocalizationResult& answer) {
  return std::tuple(
      answer.localizer, answer.incarnation, answer.keyframe, answer.revision, answer.status);
}

}  // namespace

CloudClient::CloudClient(RobotId robot, Channel& channel, const Config& config)
    : robot_(std::move(robot)),
      channel_(channel),
      config_(config),
      selector_(robot_, config.selector) {}

void CloudClient::start_session(const RobotSession& session, Timestamp now) {
  session_ = session;
  newest_start_ = session.start;
  session_started_ = now;
  newest_.reset();
  correction_.reset();
  corrected_anchor_.reset();
  if (!localizer_.empty()) return start_stream(now);
  update_localizer(now);
}

void CloudClient::submit(Submap submap, Timestamp now) {
  if (localizer_.empty() || !session_) {
    ++statistics_.submaps_without_localizer;
    return;
  }
  submap.robot = robot_;
  sender_.prepare(submap, now);
  try {
    channel_.send(localizer_, {Topic::kSubmap, encode(submap)}, now);
    ++statistics_.submaps_sent;
    selector_.sent(now);
  } catch (const NotEncodable&) {  // out of range of the wire type; the next one may fit
    refuse("not_encodable");
  }
}

std::vector<LocalizationResult> CloudClient::take_answers(Timestamp now) {
  std::vector<LocalizationResult> answers;
  for (const Message& message : channel_.receive(now)) {
    if (message.topic == Topic::kLocalizerStatus) receive_status(message.payload, now);
    if (message.topic == Topic::kCorrection) receive_correction(message.payload);
    if (message.topic != Topic::kLocalization) continue;
    if (auto answer = receive_answer(message.payload, now)) answers.push_back(std::move(*answer));
  }
  if (session_) update_localizer(now);  // after the status messages
  repeat_announcement(now);
  send_status(now);
  return answers;
}

void CloudClient::note_applied() {
  ++answers_applied_;
  if (answered_map_) selector_.require_map(*answered_map_);
}

void CloudClient::receive_status(const Bytes& payload, Timestamp now) {
  auto decoded = decode_localizer_status(payload);
  if (!decoded) return refuse(name(decoded.error()));
  const auto& status = *decoded;
  const auto reason = selector_.update(status, now);
  if (!reason) return;
  if (*reason == "conflicting_localizer" && !statistics_.refused.contains(std::string(*reason))) {
    note("two localizers are named " + status.localizer + ": the one started first is not used");
  }
  refuse(*reason);
}

void CloudClient::receive_correction(const Bytes& payload) {
  auto decoded = decode_correction(payload);
  if (!decoded) return refuse(name(decoded.error()));
  auto& correction = *decoded;
  if (correction.robot != robot_ || !session_ || correction.session != session_->session) {
    return refuse("correction_of_other_session");
  }
  if (correction.localizer != localizer_) return refuse("correction_of_other_localizer");
  if (correction.incarnation != selector_.incarnation())
    return refuse("correction_of_other_incarnation");
  if (corrected_anchor_ && correction.anchor <= *corrected_anchor_) {
    return refuse("outdated_correction");
  }
  corrected_anchor_ = correction.anchor;
  correction_ = std::move(correction);
}

std::optional<LocalizationResult> CloudClient::receive_answer(const Bytes& payload, Timestamp now) {
  auto decoded = decode_localization_result(payload);
  if (!decoded) {
    refuse(name(decoded.error()));
    return std::nullopt;
  }
  auto& answer = *decoded;
  if (const auto reason = rejection_reason(answer)) {
    refuse(*reason);
    check_for_duplicate_id(answer, now);
    return std::nullopt;
  }
  if (answer.status == LocalizationStatus::kNeedFull) {
    session_requested(answer, now);
    return std::nullopt;
  }
  answered_ = true;
  selector_.answered(now);
  sender_.acknowledge(answer, now);
  if (newest_ && identity(*newest_) == identity(answer)) return std::nullopt;  // repeated
  if (answer.status == LocalizationStatus::kLocalized) answered_map_ = answer.map_hash;
  newest_ = answer;
  ++statistics_.answers_received;
  return std::move(answer);
}

std::optional<std::string_view> CloudClient::rejection_reason(
    const LocalizationResult& answer) const {
  if (answer.robot != robot_ || !session_ || answer.session != session_->session) {
    return "other_session";
  }
  if (answer.localizer != localizer_) return "other_localizer";
  const bool asks = answer.status == LocalizationStatus::kNeedFull;
  if (asks && !sender_.awaits(answer.keyframe)) return "not_asked";
  if (answer.incarnation < selector_.incarnation() ||
      (!asks && answer.incarnation != selector_.incarnation())) {
    return "other_incarnation";
  }
  if (!selector_.accepts_map(answer.map_hash) && !asks) return "other_map";
  return std::nullopt;
}

// The localizer does not know the session: it was restarted, has dropped it or never received it.
void CloudClient::session_requested(const LocalizationResult& answer, Timestamp now) {
  ++statistics_.sessions_requested;
  answered_ = false;
  if (answer.incarnation != selector_.incarnation()) {  // its status follows, with its load
    const LocalizerStatus status{.localizer = answer.localizer,
                                 .incarnation = answer.incarnation,
                                 .map_hash = answer.map_hash,
                                 .accepting = true};
    static_cast<void>(selector_.update(status, now));
    return;
  }
  announcement_interval_s_ = config_.announcement_interval_s;
  if (to_seconds(now - *announced_) < config_.min_announcement_interval_s) return;
  announce_newest_start(now);
}

// After kSettledSeconds no answer to an earlier session of this robot can be in flight.
void CloudClient::check_for_duplicate_id(const LocalizationResult& answer, Timestamp now) {
  constexpr double kSettledSeconds = 30.0;
  constexpr int kTooMany = 3;
  if (!session_ || answer.robot != robot_ || answer.session == session_->session) return;
  if (to_seconds(now - *session_started_) < kSettledSeconds) return;
  if (++foreign_answers_ == kTooMany) {
    note("answers to another session arrive: another robot seems to have this id");
  }
}

void CloudClient::report_warning() {
  if (reported_warning_ == selector_.warning()) return;
  reported_warning_ = selector_.warning();
  note(reported_warning_.empty() ? "localizer " + localizer_ + " is fine again"
                                 : "localizer " + reported_warning_ + ", and there is no other");
}

void CloudClient::update_localizer(Timestamp now) {
  using Change = LocalizerSelector::Change;
  const Change change = selector_.decide(now, link());
  if (selector_.name().empty() && other_map_ != selector_.other_map()) {
    other_map_ = selector_.other_map();
    if (!other_map_.empty()) {
      note("localizer " + other_map_ + " is refused: it has another map; dead reckoning");
    }
  }
  if (change == Change::kNone) return report_warning();
  reported_warning_.clear();
  if (localizer_ != selector_.name() && !localizer_.empty()) channel_.release(localizer_);
  if (change == Change::kLeft) note("localizer " + localizer_ + " is left: " + selector_.reason());
  localizer_ = selector_.name();
  if (change == Change::kLeft) return;
  ++statistics_.localizers_chosen;
  other_map_.clear();
  note("localizer " + localizer_ + ", started as " +
       std::to_string(static_cast<std::uint32_t>(selector_.incarnation())) + ": " +
       selector_.reason());
  start_stream(now);
}

// Starts the submap stream of this session to this incarnation of the localizer.
void CloudClient::start_stream(Timestamp now) {
  answered_ = false;
  status_sent_.reset();
  announcement_interval_s_ = config_.announcement_interval_s;
  if (!session_) return;
  sender_.restart(session_->session, selector_.incarnation());
  announce_newest_start(now);
}

// For a localizer without this session. Repetitions carry the same start: another one would make
// the localizer restart the session.
void CloudClient::announce_newest_start(Timestamp now) {
  session_->start = newest_start_;
  announce(now);
}

void CloudClient::announce(Timestamp now) {
  session_->localizer = localizer_;
  session_->incarnation = selector_.incarnation();
  announced_ = now;
  try {
    channel_.send("", {Topic::kSession, encode(*session_)}, now);
  } catch (const NotEncodable&) {  // start out of range of the wire type
    refuse("not_encodable");
    session_->start.reset();
    newest_start_.reset();
  }
}

// The first announcement is lost if discovery has not yet matched the localizer's reader.
void CloudClient::repeat_announcement(Timestamp now) {
  if (!session_ || localizer_.empty() || answered_) return;
  if (to_seconds(now - *announced_) < announcement_interval_s_) return;
  announcement_interval_s_ =
      std::min(2.0 * announcement_interval_s_, config_.max_announcement_interval_s);
  announce(now);
}

void CloudClient::send_status(Timestamp now) {
  if (!session_ || localizer_.empty()) return;
  if (status_sent_ && to_seconds(now - *status_sent_) < config_.status_interval_s) return;
  status_sent_ = now;
  const RobotStatus status{.robot = robot_,
                           .session = session_->session,
                           .start_stamp = session_->start_stamp,
                           .stamp = now,
                           .quality = quality_,
                           .submaps_sent = statistics_.submaps_sent,
                           .answers_applied = answers_applied_,
                           .round_trip = sender_.round_trip()};
  channel_.send(localizer_, {Topic::kRobotStatus, encode(status)}, now);
}

void CloudClient::note(std::string event) {
  if (events_.size() < kMaxEvents) events_.push_back(std::move(event));
}

std::vector<std::string> CloudClient::take_events() {
  return std::exchange(events_, {});
}

LocalizerSelector::Link CloudClient::link() const {
  return {.round_trip = sender_.round_trip(), .loss = sender_.loss()};
}

CloudClient::Statistics CloudClient::statistics() const {
  Statistics statistics = statistics_;
  statistics.round_trip = sender_.round_trip();
  statistics.loss = sender_.loss();
  statistics.localizer = localizer_;
  return statistics;
}

LinkTraffic CloudClient::traffic() const {
  const ChannelStatistics bytes = channel_.statistics();
  return {.submaps_sent = statistics_.submaps_sent,
          .uplink_bytes = bytes.sent_payload_bytes,
          .downlink_bytes = bytes.received_payload_bytes,
          .uplink_wire_bytes = bytes.sent_wire_bytes,
          .downlink_wire_bytes = bytes.received_wire_bytes,
          .loss = sender_.loss(),
          .round_trip = sender_.round_trip()};
}

CloudClient::Config read_cloud_client_config(ConfigReader config) {
  ConfigReader announcement = config.section("announcement");
  return {.selector = read_localizer_selector_config(config.section("selector")),
          .announcement_interval_s = announcement.positive("interval_s"),
          .max_announcement_interval_s = announcement.positive("max_interval_s"),
          .min_announcement_interval_s = announcement.positive("min_interval_s"),
          .status_interval_s = config.positive("status_interval_s")};
}

}  // namespace fleetloc
