#include "robot/cloud_client/cloud_client.hpp"

#include <utility>

#include "shared/compact/answer_sample.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/wire/status_codec.hpp"

namespace fleetloc {

CloudClient::CloudClient(RobotId robot, Channel& channel, const Config& config)
    : robot_(std::move(robot)),
      channel_(channel),
      writers_(config.selector.known.status_timeout_s),
      selector_(robot_, config.selector),
      connections_(channel, config.connections),
      streams_(robot_, channel, config.stream),
      status_timer_(config.status) {}

Timestamp CloudClient::time_at(Timestamp clock) {
  clock_ = clock;
  return steady_(clock);
}

void CloudClient::start_session(const RobotSession& session, Timestamp clock) {
  const Timestamp now = time_at(clock);
  selector_.drop_successor();
  streams_.start_session(session, clock_);
  begin_session(now);
}

void CloudClient::restart_session(const RobotSession& session, Timestamp clock) {
  const Timestamp now = time_at(clock);
  selector_.drop_successor();
  streams_.restart_session(session, clock_);
  begin_session(now);
}

void CloudClient::begin_session(Timestamp now) {
  answers_.start_session();
  events_.start_session(now);
  if (!selector_.name().empty()) return use_chosen(now);
  update_localizer(now);
}

void CloudClient::update_start(const MapOdomEstimate& start) {
  streams_.update_start(start);
}

void CloudClient::submit(Submap submap, Timestamp clock) {
  const Timestamp now = time_at(clock);
  const LocalizerStream& stream = streams_.current();
  if (stream.localizer().empty() || !stream.has_session()) {
    ++statistics_.submaps_without_localizer;
  }
  streams_.add(std::move(submap));
  send_submaps(now);
}

void CloudClient::send_submaps(Timestamp now) {
  const SessionStreams::Sent sent = streams_.send_submaps(stream_time(now));
  if (sent.to_current) {
    ++statistics_.submaps_sent;
    selector_.sent(now);
  }
  if (sent.to_successor) ++statistics_.submaps_sent;
}

std::vector<LocalizationResult> CloudClient::take_answers(Timestamp clock) {
  const Timestamp now = time_at(clock);
  std::vector<LocalizationResult> answers;
  for (const Message& message : channel_.receive(clock_)) {
    if (message.topic == Topic::kLocalizerStatus) receive_status(message, now);
    if (message.topic != Topic::kLocalization) continue;
    if (auto answer = receive_answer(message, now)) answers.push_back(std::move(*answer));
  }
  if (streams_.current().has_session()) update_localizer(now);  // after the status messages
  streams_.repeat_announcements(stream_time(now));
  send_submaps(now);
  send_status(now);
  return answers;
}

void CloudClient::note_applied() {
  ++answers_applied_;
  if (answers_.map()) selector_.require_map(*answers_.map());
}

void CloudClient::receive_status(const Message& message, Timestamp now) {
  const auto status = decode_localizer_status(message.payload);
  if (!status) return refuse(status.error());
  if (!writers_.accepts(status->localizer, message.sender, now)) {
    events_.foreign_writer(status->localizer);
    return refuse(MessageRefusal::kForeignWriter);
  }
  const auto taken = selector_.update(*status, now);
  if (taken) return;
  if (taken.error() == StatusRefusal::kConflict) events_.conflict(status->localizer);
  refuse(taken.error());
}

std::optional<LocalizationResult> CloudClient::receive_answer(const Message& message,
                                                              Timestamp now) {
  auto decoded = decode_answer(message.payload);
  if (!decoded) {
    refuse(decoded.error());
    return std::nullopt;
  }
  LocalizationResult& answer = decoded->result;
  if (!writers_.accepts_if_bound(answer.localizer, message.sender, now)) {
    refuse(MessageRefusal::kForeignWriter);
    return std::nullopt;
  }
  if (const auto valid = check(answer); !valid) {
    refuse(valid.error());
    check_for_duplicate_id(answer, now);
    return std::nullopt;
  }
  if (answer.status == LocalizationStatus::kNeedFull) {
    session_requested(answer, now);
    return std::nullopt;
  }
  streams_.answered(answer, now);
  if (streams_.is_successor(answer.localizer) && !take_over(answer, now)) return std::nullopt;
  selector_.answered(now);
  if (decoded->correction) answers_.add(*std::move(decoded->correction));
  if (!answers_.add(answer, now)) return std::nullopt;  // repeated
  ++statistics_.answers_received;
  return std::move(answer);
}

expected<void, MessageRefusal> CloudClient::check(const LocalizationResult& answer) const {
  const bool asks = answer.status == LocalizationStatus::kNeedFull;
  const auto valid = streams_.of(answer.localizer).check(answer);
  if (valid && !selector_.accepts_map(answer.map_hash) && !asks) {
    return unexpected(MessageRefusal::kOtherMap);
  }
  return valid;
}

void CloudClient::check_for_duplicate_id(const LocalizationResult& answer, Timestamp now) {
  const LocalizerStream& stream = streams_.current();
  if (!stream.has_session() || answer.robot != robot_) return;
  if (answer.session != stream.session().session) events_.foreign_answer(now);
}

void CloudClient::session_requested(const LocalizationResult& answer, Timestamp now) {
  ++statistics_.sessions_requested;
  if (answer.incarnation == streams_.of(answer.localizer).incarnation()) {
    return streams_.announce_again_to(answer.localizer, stream_time(now));
  }
  const LocalizerStatus status{.localizer = answer.localizer,  // the real one follows
                               .incarnation = answer.incarnation,
                               .map_hash = answer.map_hash,
                               .accepting = true};
  static_cast<void>(selector_.update(status, now));
}

// By the successor, if its answer is good enough.
bool CloudClient::take_over(const LocalizationResult& answer, Timestamp now) {
  if (!answers_.is_matched_by(answer, *selector_.successor(), now)) {
    selector_.successor_answered(now);
    return false;
  }
  selector_.take_over(now);
  choose(now);
  return true;
}

void CloudClient::update_localizer(Timestamp now) {
  using Change = LocalizerSelector::Change;
  const LocalizerSelector::Link link{.round_trip = sender().round_trip(), .loss = sender().loss()};
  switch (selector_.decide(now, link)) {
    case Change::kNone:
      events_.unchanged(selector_);
      break;
    case Change::kLeft:
      events_.left(streams_.current().localizer(), selector_);
      streams_.end(clock_);
      break;
    case Change::kSuccessor:
      begin_successor(now);
      break;
    case Change::kStays:
      events_.stays(selector_.name());
      streams_.drop_successor(clock_);
      break;
    case Change::kChosen:
    case Change::kRestarted:
      choose(now);
  }
  keep_connections(now);
}

void CloudClient::choose(Timestamp now) {
  use_chosen(now);
  ++statistics_.localizers_chosen;
  events_.chosen(selector_);
}

// It is told the quality, too.
void CloudClient::use_chosen(Timestamp now) {
  streams_.use(selector_.name(), selector_.incarnation(), stream_time(now));
  status_timer_.reset();
}

void CloudClient::begin_successor(Timestamp now) {
  const LocalizerSelector::Successor& successor = *selector_.successor();
  ++statistics_.successors;
  events_.to_take_over(successor);
  streams_.begin_successor(successor.name, successor.incarnation, stream_time(now));
}

// The others are told of the session, too: so they are ready to answer.
void CloudClient::keep_connections(Timestamp now) {
  const std::string& current = streams_.current().localizer();
  if (current.empty()) return;
  std::vector<std::string> wanted = selector_.standbys(connections_.standbys(), now);
  wanted.push_back(current);
  if (streams_.successor()) wanted.push_back(streams_.successor()->localizer());
  for (const std::string& localizer : connections_.keep(wanted, now)) {
    if (streams_.of(localizer).localizer() != localizer) streams_.announce_to(localizer, clock_);
  }
}

void CloudClient::send_status(Timestamp now) {
  const LocalizerStream& stream = streams_.current();
  if (!stream.has_session() || stream.localizer().empty()) return;
  if (!status_timer_.due(now, quality_ != sent_quality_)) return;
  sent_quality_ = quality_;
  const RobotSession& session = stream.session();
  const RobotStatus status{.robot = robot_,
                           .session = session.session,
                           .start_stamp = session.start_stamp,
                           .stamp = clock_,
                           .quality = quality_,
                           .submaps_sent = statistics_.submaps_sent,
                           .answers_applied = answers_applied_,
                           .round_trip = sender().round_trip()};
  channel_.send(stream.localizer(), {Topic::kRobotStatus, encode(status)}, clock_);
}

CloudClient::Statistics CloudClient::statistics() const {
  Statistics statistics = statistics_;
  for (const auto& [reason, count] : streams_.refusals()) {
    statistics.refused[std::string(name(reason))] += count;
  }
  statistics.round_trip = sender().round_trip();
  statistics.loss = sender().loss();
  statistics.localizer = streams_.current().localizer();
  return statistics;
}

LinkTraffic CloudClient::traffic() const {
  const ChannelStatistics bytes = channel_.statistics();
  return {.submaps_sent = statistics_.submaps_sent,
          .uplink_bytes = bytes.sent_payload_bytes,
          .downlink_bytes = bytes.received_payload_bytes,
          .uplink_wire_bytes = bytes.sent_wire_bytes,
          .downlink_wire_bytes = bytes.received_wire_bytes,
          .loss = sender().loss(),
          .round_trip = sender().round_trip()};
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
