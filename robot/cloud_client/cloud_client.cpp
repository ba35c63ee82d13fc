#include "robot/cloud_client/cloud_client.hpp"

#include <algorithm>
#include <utility>

#include "shared/compact/answer_sample.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/wire/status_codec.hpp"

namespace fleetloc {
namespace {

constexpr std::size_t kMaxEvents = 100;  // further ones are dropped
constexpr std::size_t kMaxGiven = 64;    // some ten seconds: repetitions may be late

// Between the oldest and the newest keyframe that the answer's pose rests on.
double window_s(const LocalizationResult& answer) {
  const bool has_pose = answer.status == LocalizationStatus::kLocalized;
  return has_pose ? to_seconds(answer.stamp - answer.oldest_stamp) : 0.0;
}

}  // namespace

CloudClient::CloudClient(RobotId robot, Channel& channel, const Config& config)
    : robot_(std::move(robot)),
      channel_(channel),
      selector_(robot_, config.selector),
      connections_(channel, config.connections),
      stream_(robot_, channel, config.stream),
      status_timer_(config.status) {}

void CloudClient::start_session(const RobotSession& session, Timestamp clock) {
  const Timestamp now = time_at(clock);
  if (successor_) {  // what it was brought is of the session before
    selector_.drop_successor();
    drop_successor();
  }
  stream_.start_session(session);
  session_started_ = now;
  given_.clear();
  window_s_ = 0.0;
  localized_.reset();
  correction_.reset();
  corrected_anchor_.reset();
  if (!selector_.name().empty()) return begin_with_chosen(now);
  update_localizer(now);
}

Timestamp CloudClient::time_at(Timestamp clock) {
  clock_ = clock;
  return steady_(clock);
}

void CloudClient::update_start(const MapOdomEstimate& start) {
  stream_.update_start(start);
  if (successor_) successor_->update_start(start);
}

void CloudClient::submit(Submap submap, Timestamp clock) {
  const Timestamp now = time_at(clock);
  if (stream_.localizer().empty() || !stream_.has_session()) {
    ++statistics_.submaps_without_localizer;
  }
  if (successor_) successor_->add(submap);
  stream_.add(std::move(submap));
  send_submaps(now);
}

void CloudClient::send_submaps(Timestamp now) {
  if (taken(stream_.send_submap(stream_time(now)))) {
    ++statistics_.submaps_sent;
    selector_.sent(now);
  }
  if (successor_ && taken(successor_->send_submap(stream_time(now)))) ++statistics_.submaps_sent;
}

std::vector<LocalizationResult> CloudClient::take_answers(Timestamp clock) {
  const Timestamp now = time_at(clock);
  std::vector<LocalizationResult> answers;
  for (const Message& message : channel_.receive(clock_)) {
    if (message.topic == Topic::kLocalizerStatus) receive_status(message.payload, now);
    if (message.topic != Topic::kLocalization) continue;
    if (auto answer = receive_answer(message.payload, now)) answers.push_back(std::move(*answer));
  }
  if (stream_.has_session()) update_localizer(now);  // after the status messages
  count(stream_.repeat_announcement(stream_time(now)));
  if (successor_) count(successor_->repeat_announcement(stream_time(now)));
  send_submaps(now);
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
  const bool is_of_successor = successor_ && answer.localizer == successor_->localizer();
  LocalizerStream& stream = is_of_successor ? *successor_ : stream_;
  if (const auto valid = check(stream, answer); !valid) {
    refuse(valid.error());
    check_for_duplicate_id(answer, now);
    return std::nullopt;
  }
  if (answer.status == LocalizationStatus::kNeedFull) {
    session_requested(stream, answer, now);
    return std::nullopt;
  }
  stream.answered(answer, now);
  if (is_of_successor) {
    if (!may_take_over(answer, now)) {
      selector_.successor_answered(now);
      return std::nullopt;
    }
    selector_.take_over(now);
    hand_over();
  }
  selector_.answered(now);
  if (decoded->correction) receive_correction(*std::move(decoded->correction));
  if (std::ranges::find(given_, identity(answer)) != given_.end()) return std::nullopt;  // repeated
  given_.push_back(identity(answer));
  if (given_.size() > kMaxGiven) given_.pop_front();
  if (answer.status == LocalizationStatus::kLocalized) {
    answered_map_ = answer.map_hash;
    localized_ = now;
  }
  window_s_ = window_s(answer);
  ++statistics_.answers_received;
  return std::move(answer);
}

// With a pose, from a window that is about as long as the old one's: the first keyframes that it
// gets may be too few to go on with. Where the old one is silent, or has had no pose for long,
// nothing gets worse.
bool CloudClient::may_take_over(const LocalizationResult& answer, Timestamp now) const {
  constexpr double kLongSeconds = 10.0;
  constexpr double kPatienceSeconds = 4.0;  // under loss not all keyframes arrive
  constexpr double kShareOfWindow = 0.8;
  const auto& successor = *selector_.successor();
  if (successor.is_urgent || !localized_ || to_seconds(now - *localized_) > kLongSeconds) {
    return true;
  }
  if (answer.status != LocalizationStatus::kLocalized) return false;
  if (to_seconds(now - successor.since) > kPatienceSeconds) return true;
  return window_s(answer) >= kShareOfWindow * window_s_;
}

expected<void, MessageRefusal> CloudClient::check(const LocalizerStream& stream,
                                                  const LocalizationResult& answer) const {
  const bool asks = answer.status == LocalizationStatus::kNeedFull;
  const auto valid = stream.check(answer);
  if (valid && !selector_.accepts_map(answer.map_hash) && !asks) {
    return unexpected(MessageRefusal::kOtherMap);
  }
  return valid;
}

void CloudClient::session_requested(LocalizerStream& stream,
                                    const LocalizationResult& answer,
                                    Timestamp now) {
  ++statistics_.sessions_requested;
  if (answer.incarnation == stream.incarnation()) return count(stream.requested(stream_time(now)));
  const LocalizerStatus status{.localizer = answer.localizer,  // the real one follows
                               .incarnation = answer.incarnation,
                               .map_hash = answer.map_hash,
                               .accepting = true};
  static_cast<void>(selector_.update(status, now));
}

// After kSettledSeconds no answer to an earlier session of this robot can be in flight.
void CloudClient::check_for_duplicate_id(const LocalizationResult& answer, Timestamp now) {
  constexpr double kSettledSeconds = 30.0;
  constexpr int kTooMany = 3;
  if (!stream_.has_session() || answer.robot != robot_) return;
  if (answer.session == stream_.session().session) return;
  if (to_seconds(now - *session_started_) < kSettledSeconds) return;
  if (++foreign_answers_ == kTooMany) {
    note("answers to another session arrive: another robot seems to have this id");
  }
}

void CloudClient::report_warning() {
  if (reported_warning_ == selector_.warning()) return;
  reported_warning_ = selector_.warning();
  note(reported_warning_.empty() ? "localizer " + selector_.name() + " is fine again"
                                 : "localizer " + reported_warning_ + ", and there is no other");
}

void CloudClient::update_localizer(Timestamp now) {
  using Change = LocalizerSelector::Change;
  switch (selector_.decide(now, link())) {
    case Change::kNone:
      report_other_map();
      report_warning();
      break;
    case Change::kLeft:
      note("localizer " + stream_.localizer() + " is left: " + selector_.reason());
      reported_warning_.clear();
      drop_successor();
      stream_.end();
      report_other_map();
      break;
    case Change::kSuccessor:
      drop_successor();
      begin_successor(now);
      break;
    case Change::kStays:
      note("localizer " + stream_.localizer() + " goes on");
      drop_successor();
      break;
    case Change::kChosen:
    case Change::kRestarted:
      choose(now);
  }
  keep_connections(now);
}

void CloudClient::report_other_map() {
  if (!selector_.name().empty() || other_map_ == selector_.other_map()) return;
  other_map_ = selector_.other_map();
  if (other_map_.empty()) return;
  note("localizer " + other_map_ + " is refused: it has another map; dead reckoning");
}

// The one that is left is told, too, and ends the session at once.
void CloudClient::choose(Timestamp now) {
  if (successor_ && successor_->localizer() == selector_.name()) return hand_over();
  drop_successor();
  const std::string left = stream_.localizer();
  note_chosen();
  begin_with_chosen(now);
  if (!left.empty() && left != stream_.localizer()) count(stream_.announce_to(left, clock_));
}

void CloudClient::begin_successor(Timestamp now) {
  const LocalizerSelector::Successor& successor = *selector_.successor();
  ++statistics_.successors;
  note("localizer " + successor.name + " is to take over: " + successor.reason);
  successor_ = stream_;
  count(successor_->begin(successor.name, successor.incarnation, stream_time(now)));
}

// It is told that it is not needed.
void CloudClient::drop_successor() {
  if (!successor_) return;
  if (!stream_.localizer().empty()) count(stream_.announce_to(successor_->localizer(), clock_));
  stream_.note_numbers_of(*successor_);
  successor_.reset();
}

void CloudClient::hand_over() {
  const std::string left = stream_.localizer();
  successor_->note_numbers_of(stream_);
  stream_ = *std::exchange(successor_, std::nullopt);
  status_timer_.reset();
  note_chosen();
  count(stream_.announce_to(left, clock_));
}

void CloudClient::note_chosen() {
  ++statistics_.localizers_chosen;
  reported_warning_.clear();
  other_map_.clear();
  note("localizer " + selector_.name() + ", started as " +
       std::to_string(static_cast<std::uint32_t>(selector_.incarnation())) + ": " +
       selector_.reason());
}

// The others are told of the session, too: so they are ready to answer.
void CloudClient::keep_connections(Timestamp now) {
  if (stream_.localizer().empty()) return;
  std::vector<std::string> wanted = selector_.standbys(connections_.standbys(), now);
  wanted.push_back(stream_.localizer());
  if (successor_) wanted.push_back(successor_->localizer());
  for (const std::string& localizer : connections_.keep(wanted, now)) {
    const bool is_in_use =
        localizer == stream_.localizer() || (successor_ && localizer == successor_->localizer());
    if (!is_in_use) count(stream_.announce_to(localizer, clock_));
  }
}

// The submap stream of this session to this incarnation of the localizer.
void CloudClient::begin_with_chosen(Timestamp now) {
  status_timer_.reset();
  count(stream_.begin(selector_.name(), selector_.incarnation(), stream_time(now)));
}

void CloudClient::send_status(Timestamp now) {
  if (!stream_.has_session() || stream_.localizer().empty()) return;
  if (!status_timer_.due(now, quality_ != sent_quality_)) return;
  sent_quality_ = quality_;
  const RobotSession& session = stream_.session();
  const RobotStatus status{.robot = robot_,
                           .session = session.session,
                           .start_stamp = session.start_stamp,
                           .stamp = clock_,
                           .quality = quality_,
                           .submaps_sent = statistics_.submaps_sent,
                           .answers_applied = answers_applied_,
                           .round_trip = stream_.uplink().sender().round_trip()};
  channel_.send(stream_.localizer(), {Topic::kRobotStatus, encode(status)}, clock_);
}

void CloudClient::note(std::string event) {
  if (events_.size() < kMaxEvents) events_.push_back(std::move(event));
}

std::vector<std::string> CloudClient::take_events() {
  return std::exchange(events_, {});
}

LocalizerSelector::Link CloudClient::link() const {
  return {.round_trip = stream_.uplink().sender().round_trip(),
          .loss = stream_.uplink().sender().loss()};
}

CloudClient::Statistics CloudClient::statistics() const {
  Statistics statistics = statistics_;
  statistics.round_trip = stream_.uplink().sender().round_trip();
  statistics.loss = stream_.uplink().sender().loss();
  statistics.localizer = stream_.localizer();
  return statistics;
}

LinkTraffic CloudClient::traffic() const {
  const ChannelStatistics bytes = channel_.statistics();
  return {.submaps_sent = statistics_.submaps_sent,
          .uplink_bytes = bytes.sent_payload_bytes,
          .downlink_bytes = bytes.received_payload_bytes,
          .uplink_wire_bytes = bytes.sent_wire_bytes,
          .downlink_wire_bytes = bytes.received_wire_bytes,
          .loss = stream_.uplink().sender().loss(),
          .round_trip = stream_.uplink().sender().round_trip()};
}

CloudClient::Config read_cloud_client_config(ConfigReader config) {
  ConfigReader announcement = config.section("announcement");
  return {.selector = read_localizer_selector_config(config.section("selector")),
          .connections = read_localizer_connections_config(config.section("connections")),
          .stream = {.announcement = {.interval_s = announcement.positive("interval_s"),
                                      .max_interval_s = announcement.positive("max_interval_s"),
                                      .min_interval_s = announcement.positive("min_interval_s")},
                     .uplink = read_submap_uplink_config(config.section("uplink"))},
          .status = read_status_timer_config(config.section("status"))};
}

}  // namespace fleetloc
