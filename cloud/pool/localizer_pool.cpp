#include "cloud/pool/localizer_pool.hpp"

#include <algorithm>
#include <utility>

#include "shared/config/config_reader.hpp"
#include "shared/protocol/session_rule.hpp"
#include "shared/wire/answer_codec.hpp"
#include "shared/wire/correction_codec.hpp"
#include "shared/wire/session_codec.hpp"
#include "shared/wire/status_codec.hpp"
#include "shared/wire/submap_codec.hpp"

namespace fleetloc {

LocalizerPool::LocalizerPool(std::string name,
                             Epoch epoch,
                             std::shared_ptr<const LaserMap> map,
                             const Config& config)
    : name_(std::move(name)), epoch_(epoch), map_(std::move(map)), config_(config) {}

void LocalizerPool::receive(const Message& message, Timestamp now) {
  if (message.topic == Topic::kSession) receive_session(message.payload);
  if (message.topic == Topic::kSubmap) receive_submap(message.payload, now);
}

void LocalizerPool::receive_session(const Bytes& payload) {
  auto decoded = decode_robot_session(payload);
  if (const auto* reason = std::get_if<Malformed>(&decoded)) {
    ++unattributed_[std::string(name(*reason))];
    return;
  }
  auto& session = std::get<RobotSession>(decoded);
  if (session.localizer != name_) return;
  const auto known = robots_.find(session.robot);
  if (known == robots_.end() && robots_.size() >= config_.max_sessions) {
    ++unattributed_["too_many_sessions"];
    return;
  }
  Robot& robot = known != robots_.end()
                     ? known->second
                     : robots_.emplace(session.robot, Robot(config_.repetition)).first->second;
  switch (judge(robot.session, session)) {
    case SessionVerdict::kReplaces:
      robot.localizer = std::make_shared<SessionLocalizer>(session, map_, config_.localizer);
      robot.receiver = {};
      robot.waiting.clear();
      robot.answer.reset();
      robot.unsent = false;
      robot.correction.reset();
      robot.session = std::move(session);
      break;
    case SessionVerdict::kRepeated:
      break;
    case SessionVerdict::kOutdated:
      refuse(session.robot, "outdated_session");
      break;
  }
}

void LocalizerPool::receive_submap(const Bytes& payload, Timestamp now) {
  auto decoded = decode_submap(payload);
  if (const auto* reason = std::get_if<Malformed>(&decoded)) {
    ++unattributed_[std::string(name(*reason))];
    return;
  }
  auto& submap = std::get<Submap>(decoded);
  const auto found = robots_.find(submap.robot);
  if (found == robots_.end()) {
    ++unattributed_["unknown_robot"];
    return;
  }
  Robot& robot = found->second;
  if (submap.session != robot.session->session) return refuse(submap.robot, "other_session");
  if (!robot.receiver.is_new(submap.number)) return refuse(submap.robot, "seen_before");
  if (robot.waiting.size() >= config_.max_waiting_submaps) {
    robot.waiting.pop_front();
    refuse(submap.robot, "overtaken");
  }
  robot.receiver.store(submap.number);
  ++robot.report.submaps;
  robot.waiting.push_back({std::move(submap), now});
}

void LocalizerPool::refuse(const RobotId& robot, std::string_view reason) {
  ++robots_.at(robot).report.refused[std::string(reason)];
}

std::optional<LocalizerPool::Job> LocalizerPool::take_job() {
  if (robots_.empty()) return std::nullopt;
  auto next = robots_.upper_bound(last_served_);
  for (std::size_t i = 0; i < robots_.size(); ++i, ++next) {
    if (next == robots_.end()) next = robots_.begin();
    auto& [id, robot] = *next;
    if (robot.busy || robot.waiting.empty()) continue;
    Job job{.robot = id,
            .received = robot.waiting.front().received,
            .session = robot.localizer,
            .submaps = {},
            .correction = {},
            .error = {}};
    for (Waiting& waiting : robot.waiting) {
      job.submaps.push_back(std::move(waiting.submap));
    }
    robot.waiting.clear();
    robot.busy = true;
    last_served_ = id;
    return job;
  }
  return std::nullopt;
}

// Whatever one robot's submaps bring about, the others are served.
Answer LocalizerPool::run(Job& job) {
  try {
    for (const Submap& submap : job.submaps) job.session->add(submap);
    Answer answer = job.session->localize();
    job.correction = job.session->correction();
    return answer;
  } catch (const std::exception& error) {
    job.error = error.what();
    const SubmapKeyframe& newest = job.submaps.back().keyframes.back();
    Answer answer;
    answer.status = LocalizationStatus::kNotConverged;
    answer.keyframe = newest.id;
    answer.revision = newest.revision;
    answer.stamp = newest.stamp;
    return answer;
  }
}

void LocalizerPool::finish(const Job& job, Answer answer, double optimize_ms, Timestamp now) {
  Robot& robot = robots_.at(job.robot);
  robot.busy = false;
  if (robot.localizer != job.session) return;  // the session was replaced meanwhile
  SessionReport& report = robot.report;
  if (!job.error.empty()) ++report.refused["error: " + job.error];
  if (answer.status == LocalizationStatus::kLocalized) {
    ++report.localized;
  } else {
    ++report.rejected[std::string(name(answer.status))];
  }
  report.optimize_ms.push_back(optimize_ms);
  report.matches.push_back(job.session->diagnostics().matches);
  answer.robot = job.robot;
  answer.session = robot.session->session;
  answer.localizer = name_;
  answer.epoch = epoch_;
  answer.map_hash = map_->info().hash;
  answer.holding_time = now - job.received;
  robot.correction = job.correction;
  if (robot.correction) {
    robot.correction->robot = answer.robot;
    robot.correction->session = answer.session;
    robot.correction->localizer = answer.localizer;
    robot.correction->epoch = answer.epoch;
  }
  robot.answer = std::move(answer);
  robot.unsent = true;
}

std::vector<LocalizerPool::Outgoing> LocalizerPool::outgoing(Timestamp now, double load) {
  std::vector<Outgoing> messages;
  for (auto& [id, robot] : robots_) {
    if (!robot.answer) continue;
    if (!robot.unsent && !robot.repetition.due(now, robot.receiver.loss())) continue;
    robot.answer->acknowledgements = robot.receiver.acknowledgements();
    if (robot.unsent) robot.repetition.sent(now);
    robot.unsent = false;
    try {
      messages.push_back({id, {Topic::kLocalization, encode(*robot.answer)}});
    } catch (const NotEncodable&) {  // a solution beyond all bounds harms only its own robot
      robot.answer.reset();
      refuse(id, "not_encodable");
    }
    send_correction(id, robot, messages);
  }
  if (!status_sent_ || to_seconds(now - *status_sent_) >= config_.status_interval_s) {
    status_sent_ = now;
    messages.push_back({"", {Topic::kLocalizerStatus, encode(status(load))}});
  }
  return messages;
}

// Once: a lost one is made up for by the next.
void LocalizerPool::send_correction(const RobotId& id,
                                    Robot& robot,
                                    std::vector<Outgoing>& messages) {
  if (!robot.correction) return;
  try {
    messages.push_back({id, {Topic::kCorrection, encode(*robot.correction)}});
  } catch (const NotEncodable&) {
    refuse(id, "correction_not_encodable");
  }
  robot.correction.reset();
}

LocalizerStatus LocalizerPool::status(double load) const {
  return {.localizer = name_,
          .epoch = epoch_,
          .map_hash = map_->info().hash,
          .sessions = static_cast<int>(robots_.size()),
          .load = std::clamp(load, 0.0, 1.0),
          .accepting = robots_.size() < config_.max_sessions};
}

std::map<RobotId, SessionReport> LocalizerPool::reports() const {
  std::map<RobotId, SessionReport> reports;
  for (const auto& [id, robot] : robots_) {
    SessionReport& report = reports[id] = robot.report;
    if (robot.localizer && !robot.busy) report.memory_bytes = robot.localizer->memory_bytes();
  }
  return reports;
}

LocalizerPool::Config read_localizer_pool_config(ConfigReader config) {
  ConfigReader pool = config.section("pool");
  return {.localizer = read_session_localizer_config(config.section("localizer")),
          .max_sessions = static_cast<std::size_t>(pool.integer("max_sessions", 1, 100'000)),
          .max_waiting_submaps =
              static_cast<std::size_t>(pool.integer("max_waiting_submaps", 1, 10'000)),
          .status_interval_s = pool.positive("status_interval_s"),
          .repetition = read_repetition_config(pool.section("repetition"))};
}

}  // namespace fleetloc
