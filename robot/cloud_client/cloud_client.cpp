#include "robot/cloud_client/cloud_client.hpp"

#include <algorithm>
#include <utility>

#include "shared/compact/answer_sample.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/wire/session_codec.hpp"
#include "shared/wire/status_codec.hpp"

namespace fleetloc {
namespace {

constexpr std::size_t kMaxEvents = 100;  // further ones are dropped
constexpr std::size_t kMaxGiven = 64;    // some ten seconds: repetitions may be late

}  // namespace

CloudClient::CloudClient(RobotId robot, Channel& channel, const Config& config)
    : robot_(std::move(robot)),
      channel_(channel),
      selector_(robot_, config.selector),
      connections_(channel, config.connections),
      announcer_(config.announcement),
      uplink_(robot_, config.uplink),
      status_timer_(config.status) {}

void CloudClient::start_session(const RobotSession& session, Timestamp clock) {
  const Timestamp now = time_at(clock);
  announcer_.start(session);
  announcer_.set_encoding(uplink_.encoding());
  uplink_.start_session(session.stereo);
  session_started_ = now;
  given_.clear();
  correction_.reset();
  corrected_anchor_.reset();
  if (!localizer_.empty()) return start_stream(now);
  update_localizer(now);
}

Timestamp CloudClient::time_at(Timestamp clock) {
  clock_ = clock;
  return steady_(clock);
}

void CloudClient::submit(Submap submap, Timestamp clock) {
  const Timestamp now = time_at(clock);
  if (localizer_.empty() || !announcer_.session()) ++statistics_.submaps_without_localizer;
  uplink_.add(std::move(submap));
  send_submap(now);
}

void CloudClient::send_submap(Timestamp now) {
  if (localizer_.empty() || !announcer_.session()) return;
  try {
    if (receipt_.newest != 0) receipt_.age = answers_.since_newest(now);
    auto message = uplink_.next(receipt_, now);
    if (!message) return;
    channel_.send(localizer_, *std::move(message), clock_);
    ++statistics_.submaps_sent;
    selector_.sent(now);
  } catch (const NotEncodable&) {  // out of range of the wire type; the next one may fit
    refuse(MessageRefusal::kNotEncodable);
  }
}

std::vector<LocalizationResult> CloudClient::take_answers(Timestamp clock) {
  const Timestamp now = time_at(clock);
  std::vector<LocalizationResult> answers;
  for (const Message& message : channel_.receive(clock_)) {
    if (message.topic == Topic::kLocalizerStatus) receive_status(message.payload, now);
    if (message.topic != Topic::kLocalization) continue;
    if (auto answer = receive_answer(message.payload, now)) answers.push_back(std::move(*answer));
  }
  if (announcer_.session()) update_localizer(now);  // after the status messages
  if (!localizer_.empty()) {
    if (const auto repetition = announcer_.repetition(now)) announce(*repetition, localizer_);
  }
  send_submap(now);
  send_status(now);
  return answers;
}

void CloudClient::note_applied() {
  ++answers_applied_;
  if (answered_map_) selector_.require_map(*answered_map_);
}

void CloudClient::receive_status(const Bytes& payload, Timestamp now) {
  auto decoded = decode_localizer_status(payload);
  if (!decoded) return refuse(decoded.error());
  const auto& status = *decoded;
  const auto taken = selector_.update(status, now);
  if (taken) return;
  const bool is_first = !statistics_.refused.contains(std::string(name(taken.error())));
  if (is_first && taken.error() == StatusRefusal::kConflict) {
    note("two localizers are named " + status.localizer + ": the one started first is not used");
  }
  refuse(taken.error());
}

// The newest one counts; a repeated or late answer brings none.
void CloudClient::receive_correction(Correction correction) {
  if (corrected_anchor_ && correction.anchor <= *corrected_anchor_) return;
  corrected_anchor_ = correction.anchor;
  correction_ = std::move(correction);
}

CloudClient::AnswerIdentity CloudClient::identity(const LocalizationResult& answer) {
  return {answer.localizer, answer.incarnation, answer.keyframe, answer.revision, answer.status};
}

std::optional<LocalizationResult> CloudClient::receive_answer(const Bytes& payload, Timestamp now) {
  auto decoded = decode_answer(payload);
  if (!decoded) {
    refuse(decoded.error());
    return std::nullopt;
  }
  LocalizationResult& answer = decoded->result;
  if (const auto valid = check(answer); !valid) {
    refuse(valid.error());
    check_for_duplicate_id(answer, now);
    return std::nullopt;
  }
  if (answer.status == LocalizationStatus::kNeedFull) {
    session_requested(answer, now);
    return std::nullopt;
  }
  announcer_.answered();
  selector_.answered(now);
  uplink_.acknowledge(answer, now);
  note_receipt(answer, now);
  if (decoded->correction) receive_correction(*std::move(decoded->correction));
  if (std::ranges::find(given_, identity(answer)) != given_.end()) return std::nullopt;  // repeated
  given_.push_back(identity(answer));
  if (given_.size() > kMaxGiven) given_.pop_front();
  if (answer.status == LocalizationStatus::kLocalized) answered_map_ = answer.map_hash;
  ++statistics_.answers_received;
  return std::move(answer);
}

expected<void, MessageRefusal> CloudClient::check(const LocalizationResult& answer) const {
  using enum MessageRefusal;
  const std::optional<RobotSession>& session = announcer_.session();
  if (answer.robot != robot_ || !session || answer.session != session->session) {
    return unexpected(kOtherSession);
  }
  if (answer.localizer != localizer_) return unexpected(kOtherLocalizer);
  const bool asks = answer.status == LocalizationStatus::kNeedFull;
  if (asks && !uplink_.sender().awaits(answer.keyframe)) return unexpected(kNotAsked);
  if (answer.incarnation < selector_.incarnation() ||
      (!asks && answer.incarnation != selector_.incarnation())) {
    return unexpected(kOtherIncarnation);
  }
  if (!selector_.accepts_map(answer.map_hash) && !asks) return unexpected(kOtherMap);
  return {};
}

// Answers are numbered by the incarnation of a localizer.
void CloudClient::note_receipt(const LocalizationResult& answer, Timestamp now) {
  const SampleNumber number{answer.number};
  if (!answers_.is_new(number)) return;
  answers_.store(number, now);
  receipt_.newest = std::max(receipt_.newest, answer.number);
  receipt_.loss = answers_.expected_loss();
}

// The localizer does not know the session: it was restarted, has dropped it or never received it.
void CloudClient::session_requested(const LocalizationResult& answer, Timestamp now) {
  ++statistics_.sessions_requested;
  if (answer.incarnation != selector_.incarnation()) {  // its status follows, with its load
    const LocalizerStatus status{.localizer = answer.localizer,
                                 .incarnation = answer.incarnation,
                                 .map_hash = answer.map_hash,
                                 .accepting = true};
    static_cast<void>(selector_.update(status, now));
    return;
  }
  uplink_.forget_deliveries();
  if (const auto announcement = announcer_.requested(now)) {
    announce(*announcement, localizer_);
  }
}

// After kSettledSeconds no answer to an earlier session of this robot can be in flight.
void CloudClient::check_for_duplicate_id(const LocalizationResult& answer, Timestamp now) {
  constexpr double kSettledSeconds = 30.0;
  constexpr int kTooMany = 3;
  const std::optional<RobotSession>& session = announcer_.session();
  if (!session || answer.robot != robot_ || answer.session == session->session) return;
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
  if (change == Change::kNone) {
    report_warning();
  } else if (change == Change::kLeft) {
    note("localizer " + localizer_ + " is left: " + selector_.reason());
    reported_warning_.clear();
    localizer_.clear();
  } else {
    change_localizer(now);
  }
  keep_connections(now);
}

// The one that is left is told, too, and ends the session at once.
void CloudClient::change_localizer(Timestamp now) {
  const std::string left = std::exchange(localizer_, selector_.name());
  ++statistics_.localizers_chosen;
  reported_warning_.clear();
  other_map_.clear();
  note("localizer " + localizer_ + ", started as " +
       std::to_string(static_cast<std::uint32_t>(selector_.incarnation())) + ": " +
       selector_.reason());
  start_stream(now);
  if (!left.empty() && left != localizer_) announce(*announcer_.session(), left);
}

// The others are told of the session, too: so they are ready to answer.
void CloudClient::keep_connections(Timestamp now) {
  if (localizer_.empty()) return;
  std::vector<std::string> wanted = selector_.standbys(connections_.standbys(), now);
  wanted.push_back(localizer_);
  for (const std::string& localizer : connections_.keep(wanted, now)) {
    if (localizer != localizer_) announce(*announcer_.session(), localizer);
  }
}

// Starts the submap stream of this session to this incarnation of the localizer.
void CloudClient::start_stream(Timestamp now) {
  status_timer_.reset();
  if (!announcer_.session()) return;
  answers_ = {};
  receipt_ = {};
  uplink_.restart(announcer_.session()->session, selector_.incarnation());
  announce(announcer_.announcement(localizer_, selector_.incarnation(), now), localizer_);
}

void CloudClient::announce(const RobotSession& session, const std::string& localizer) {
  try {
    channel_.send(localizer, {Topic::kSession, encode(session)}, clock_);
  } catch (const NotEncodable&) {  // start out of range of the wire type
    refuse(MessageRefusal::kNotEncodable);
    announcer_.drop_start();
  }
}

void CloudClient::send_status(Timestamp now) {
  const std::optional<RobotSession>& session = announcer_.session();
  if (!session || localizer_.empty()) return;
  if (!status_timer_.due(now, quality_ != sent_quality_)) return;
  sent_quality_ = quality_;
  const RobotStatus status{.robot = robot_,
                           .session = session->session,
                           .start_stamp = session->start_stamp,
                           .stamp = clock_,
                           .quality = quality_,
                           .submaps_sent = statistics_.submaps_sent,
                           .answers_applied = answers_applied_,
                           .round_trip = uplink_.sender().round_trip()};
  channel_.send(localizer_, {Topic::kRobotStatus, encode(status)}, clock_);
}

void CloudClient::note(std::string event) {
  if (events_.size() < kMaxEvents) events_.push_back(std::move(event));
}

std::vector<std::string> CloudClient::take_events() {
  return std::exchange(events_, {});
}

LocalizerSelector::Link CloudClient::link() const {
  return {.round_trip = uplink_.sender().round_trip(), .loss = uplink_.sender().loss()};
}

CloudClient::Statistics CloudClient::statistics() const {
  Statistics statistics = statistics_;
  statistics.round_trip = uplink_.sender().round_trip();
  statistics.loss = uplink_.sender().loss();
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
          .loss = uplink_.sender().loss(),
          .round_trip = uplink_.sender().round_trip()};
}

CloudClient::Config read_cloud_client_config(ConfigReader config) {
  ConfigReader announcement = config.section("announcement");
  return {.selector = read_localizer_selector_config(config.section("selector")),
          .connections = read_localizer_connections_config(config.section("connections")),
          .announcement = {.interval_s = announcement.positive("interval_s"),
                           .max_interval_s = announcement.positive("max_interval_s"),
                           .min_interval_s = announcement.positive("min_interval_s")},
          .uplink = read_submap_uplink_config(config.section("uplink")),
          .status = read_status_timer_config(config.section("status"))};
}

}  // namespace fleetloc
