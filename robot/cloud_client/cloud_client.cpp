#include "robot/cloud_client/cloud_client.hpp"

#include <tuple>
#include <utility>

#include "shared/config/config_reader.hpp"
#include "shared/wire/answer_codec.hpp"
#include "shared/wire/correction_codec.hpp"
#include "shared/wire/session_codec.hpp"
#include "shared/wire/status_codec.hpp"
#include "shared/wire/submap_codec.hpp"

namespace fleetloc {
namespace {

// Two answers are the same information if they agree in this.
auto identity(const Answer& answer) {
  return std::tuple(
      answer.localizer, answer.epoch, answer.keyframe, answer.revision, answer.status);
}

}  // namespace

CloudClient::CloudClient(RobotId robot, Channel& channel, const Config& config)
    : robot_(std::move(robot)), channel_(channel), announcement_(config.session_repetition) {}

void CloudClient::start_session(const RobotSession& session, Timestamp now) {
  session_ = session;
  sender_.restart(session.session);
  newest_.reset();
  correction_.reset();
  corrected_anchor_.reset();
  answered_ = false;
  if (!localizer_.empty()) announce(now);
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
  } catch (const NotEncodable&) {  // an estimate beyond all bounds; the next one may be sane again
    refuse("not_encodable");
  }
}

std::vector<Answer> CloudClient::take_answers(Timestamp now) {
  std::vector<Answer> answers;
  for (const Message& message : channel_.receive(now)) {
    if (message.topic == Topic::kLocalizerStatus) receive_status(message.payload);
    if (message.topic == Topic::kCorrection) receive_correction(message.payload);
    if (message.topic != Topic::kLocalization) continue;
    if (auto answer = receive_answer(message.payload, now)) answers.push_back(std::move(*answer));
  }
  if (localizer_.empty()) choose_localizer(now);
  // The first announcement can be lost while the far side is still being matched.
  if (session_ && !answered_ && announcement_.due(now, 0.0)) announce(now);
  return answers;
}

void CloudClient::receive_status(const Bytes& payload) {
  auto decoded = decode_localizer_status(payload);
  if (const auto* reason = std::get_if<Malformed>(&decoded)) return refuse(name(*reason));
  auto& status = std::get<LocalizerStatus>(decoded);
  localizers_[status.localizer] = std::move(status);
}

std::optional<Answer> CloudClient::receive_answer(const Bytes& payload, Timestamp now) {
  auto decoded = decode_answer(payload);
  if (const auto* reason = std::get_if<Malformed>(&decoded)) {
    refuse(name(*reason));
    return std::nullopt;
  }
  auto& answer = std::get<Answer>(decoded);
  if (answer.robot != robot_ || !session_ || answer.session != session_->session) {
    refuse("other_session");
    return std::nullopt;
  }
  if (answer.localizer != localizer_) {
    refuse("other_localizer");
    return std::nullopt;
  }
  answered_ = true;
  sender_.acknowledge(answer, now);
  if (newest_ && identity(*newest_) == identity(answer)) return std::nullopt;  // repeated
  newest_ = answer;
  ++statistics_.answers_received;
  return std::move(answer);
}

void CloudClient::receive_correction(const Bytes& payload) {
  auto decoded = decode_correction(payload);
  if (const auto* reason = std::get_if<Malformed>(&decoded)) return refuse(name(*reason));
  auto& correction = std::get<Correction>(decoded);
  if (correction.robot != robot_ || !session_ || correction.session != session_->session) {
    return refuse("correction_of_other_session");
  }
  if (correction.localizer != localizer_) return refuse("correction_of_other_localizer");
  if (newest_ && correction.epoch < newest_->epoch) return refuse("correction_of_old_epoch");
  if (corrected_anchor_ && correction.anchor <= *corrected_anchor_) {
    return refuse("outdated_correction");
  }
  corrected_anchor_ = correction.anchor;
  correction_ = std::move(correction);
}

// The least loaded one that accepts robots; of equals the first by name.
void CloudClient::choose_localizer(Timestamp now) {
  const LocalizerStatus* best = nullptr;
  for (const auto& [id, status] : localizers_) {
    if (status.accepting && (best == nullptr || status.load < best->load)) best = &status;
  }
  if (best == nullptr) return;
  localizer_ = best->localizer;
  if (session_) announce(now);
}

void CloudClient::announce(Timestamp now) {
  session_->localizer = localizer_;
  channel_.send("", {Topic::kSession, encode(*session_)}, now);
  announcement_.sent(now);
}

CloudClient::Statistics CloudClient::statistics() const {
  Statistics statistics = statistics_;
  statistics.round_trip = sender_.round_trip();
  statistics.loss = sender_.loss();
  statistics.localizer = localizer_;
  return statistics;
}

RunTraffic CloudClient::traffic() const {
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
  return {.session_repetition = read_repetition_config(config.section("session_repetition"))};
}

}  // namespace fleetloc
