#include "cloud/pool/localizer_pool.hpp"

#include <algorithm>
#include <utility>

#include "shared/wire/correction_codec.hpp"
#include "shared/wire/localization_result_codec.hpp"
#include "shared/wire/session_codec.hpp"
#include "shared/wire/status_codec.hpp"
#include "shared/wire/submap_codec.hpp"

namespace fleetloc {
namespace {

constexpr Duration kMinJob = std::chrono::milliseconds(1);  // so that turns are taken in any case

// Unknown sessions are the pool's own affair: it remembers more of them than the register.
bool is_superseded(const SessionRegister::Acceptance& accepted) {
  return !accepted && accepted.error() != SessionRefusal::kUnknown;
}

bool is_same(const std::optional<MapOdomEstimate>& a, const std::optional<MapOdomEstimate>& b) {
  if (!a || !b) return !a && !b;
  return a->T_map_odom.R.coeffs() == b->T_map_odom.R.coeffs() &&
         a->T_map_odom.p == b->T_map_odom.p && a->covariance == b->covariance &&
         a->p_odom == b->p_odom;
}

}  // namespace

LocalizerPool::LocalizerPool(std::string name,
                             Incarnation incarnation,
                             std::shared_ptr<const LaserMap> map,
                             const Config& config)
    : name_(std::move(name)),
      incarnation_(incarnation),
      map_(std::move(map)),
      config_(config),
      register_(config.sessions) {}

void LocalizerPool::receive(const Message& message, Timestamp now) {
  if (message.topic == Topic::kSession) receive_session(message.payload, now);
  if (message.topic == Topic::kSubmap) receive_submap(message.payload, now);
  if (message.topic == Topic::kRobotStatus) receive_robot_status(message.payload, now);
}

// Announcements to other localizers are received, too: that robot has left this one.
void LocalizerPool::receive_session(const Bytes& payload, Timestamp now) {
  auto decoded = decode_robot_session(payload);
  if (!decoded) {
    ++unattributed_[std::string(name(decoded.error()))];
    return;
  }
  auto& session = *decoded;
  const auto accepted = register_.announced(session, now);
  if (is_superseded(accepted)) return refuse_superseded(session.robot, accepted.error(), now);
  if (session.localizer != name_) return end(session.robot, "went to " + session.localizer);
  if (session.incarnation != incarnation_)
    return refuse(session.robot, PoolRefusal::kOtherIncarnation);
  open(std::move(session), now);
}

void LocalizerPool::open(RobotSession session, Timestamp now) {
  const RobotId id = session.robot;
  auto known = robots_.find(id);
  if (known == robots_.end()) {
    if (robots_.size() >= config_.max_sessions) return refuse(id, PoolRefusal::kTooManySessions);
    known = robots_.emplace(id, Robot(config_.retransmission)).first;
    if (const auto departed_robot = departed_robots_.extract(id))
      known->second.report = departed_robot.mapped().report;
    unknown_robots_.erase(id);
  }
  Robot& robot = known->second;
  robot.last_message = now;
  const bool is_repeated = robot.session && robot.session->session == session.session &&
                           robot.session->start_stamp == session.start_stamp;
  if (is_repeated) return adopt_newer_start(robot, std::move(session));
  log_event(id + ": session " + std::to_string(static_cast<std::uint32_t>(session.session)) +
            (robot.session ? " replaces the one before" : " opened"));
  ++robot.report.sessions;
  robot.receiver = {};
  robot.waiting.clear();
  robot.waiting_bytes = 0;
  restart_session(robot, std::move(session));
}

// A job that runs meanwhile keeps its own session; what it finds is dropped.
void LocalizerPool::restart_session(Robot& robot, RobotSession session) {
  robot.localizer = std::make_shared<SessionLocalizer>(session, map_, config_.localizer);
  robot.answer.reset();
  robot.unsent = false;
  robot.correction.reset();
  robot.session = std::move(session);
}

// While the robot is localized here, the localizer's pose is better than the robot's new start
// pose.
void LocalizerPool::adopt_newer_start(Robot& robot, RobotSession session) {
  const bool is_localized = robot.answer && robot.answer->status == LocalizationStatus::kLocalized;
  if (is_localized || !session.start || is_same(session.start, robot.session->start)) return;
  restart_session(robot, std::move(session));
}

void LocalizerPool::receive_submap(const Bytes& payload, Timestamp now) {
  auto decoded = decode_submap(payload);
  if (!decoded) {
    ++unattributed_[std::string(name(decoded.error()))];
    return;
  }
  auto& submap = *decoded;
  const auto accepted = register_.submap(submap.robot, submap.session, now);
  if (is_superseded(accepted)) return refuse_superseded(submap.robot, accepted.error(), now);
  const auto found = robots_.find(submap.robot);
  if (found == robots_.end() || found->second.session->session != submap.session ||
      submap.incarnation != incarnation_) {
    return request_session(submap, now);
  }
  found->second.last_message = now;
  store(found->second, std::move(submap), payload.size(), now);
}

void LocalizerPool::store(Robot& robot, Submap submap, std::size_t bytes, Timestamp now) {
  if (!robot.receiver.is_new(submap.number)) return refuse(submap.robot, PoolRefusal::kSeenBefore);
  if (robot.waiting.empty() && !robot.running) robot.used = std::max(robot.used, virtual_time_);
  robot.receiver.store(submap.number);
  ++robot.report.submaps;
  robot.waiting_bytes += bytes;
  robot.waiting.push_back({.submap = std::move(submap), .received = now, .bytes = bytes});
  while (robot.waiting.size() > config_.max_waiting_submaps ||
         (robot.waiting.size() > 1 && robot.waiting_bytes > config_.max_waiting_bytes)) {
    pop_waiting(robot);
    ++robot.report.refused[std::string(name(PoolRefusal::kOvertaken))];
  }
}

void LocalizerPool::pop_waiting(Robot& robot) {
  robot.waiting_bytes -= robot.waiting.front().bytes;
  robot.waiting.pop_front();
}

void LocalizerPool::receive_robot_status(const Bytes& payload, Timestamp now) {
  const auto decoded = decode_robot_status(payload);
  if (!decoded) {
    ++unattributed_[std::string(name(decoded.error()))];
    return;
  }
  const auto& status = *decoded;
  const auto accepted = register_.status(status, now);
  const auto found = robots_.find(status.robot);
  if (accepted && found != robots_.end()) {
    found->second.last_message = now;
    found->second.report.status = status;
  } else if (is_superseded(accepted)) {
    refuse_superseded(status.robot, accepted.error(), now);
  }
}

std::optional<LocalizerPool::Job> LocalizerPool::take_job(Timestamp now) {
  Robot* next = nullptr;
  const RobotId* next_id = nullptr;
  for (auto& [id, robot] : robots_) {
    if (robot.running) continue;
    drop_stale_work(robot, now);
    if (robot.waiting.empty() || (next != nullptr && next->used <= robot.used)) continue;
    next = &robot;
    next_id = &id;
  }
  if (next == nullptr) return std::nullopt;
  Job job{.robot = *next_id,
          .received = next->waiting.front().received,
          .started = now,
          .session = next->localizer,
          .submaps = {},
          .correction = {},
          .error = {}};
  for (Waiting& waiting : next->waiting) job.submaps.push_back(std::move(waiting.submap));
  next->waiting.clear();
  next->waiting_bytes = 0;
  next->running = next->localizer;
  virtual_time_ = std::max(virtual_time_, next->used);
  return job;
}

// If even the newest has waited too long, the robot has stopped sending.
void LocalizerPool::drop_stale_work(Robot& robot, Timestamp now) const {
  if (robot.waiting.empty()) return;
  if (to_seconds(now - robot.waiting.back().received) <= config_.max_waiting_s) return;
  robot.report.refused[std::string(name(PoolRefusal::kStale))] += robot.waiting.size();
  robot.waiting.clear();
  robot.waiting_bytes = 0;
}

// An exception ends the job of one robot only.
LocalizationResult LocalizerPool::run(Job& job) {
  try {
    for (const Submap& submap : job.submaps) job.session->add(submap);
    LocalizationResult answer = job.session->localize();
    job.correction = job.session->correction();
    return answer;
  } catch (const std::exception& error) {
    job.error = error.what();
    const SubmapKeyframe& newest = job.submaps.back().keyframes.back();
    LocalizationResult answer;
    answer.status = LocalizationStatus::kNotConverged;
    answer.keyframe = newest.id;
    answer.revision = newest.revision;
    answer.stamp = newest.stamp;
    return answer;
  }
}

void LocalizerPool::finish(const Job& job,
                           LocalizationResult answer,
                           double optimize_ms,
                           Timestamp now) {
  const auto found = robots_.find(job.robot);
  if (found == robots_.end()) return;
  Robot& robot = found->second;
  if (robot.running == job.session) {
    robot.running.reset();
    robot.used += std::max(kMinJob, now - job.started);
  }
  if (robot.localizer != job.session) return;  // the session was replaced meanwhile
  SessionReport& report = robot.report;
  if (!job.error.empty()) {
    ++report.refused[std::string(name(PoolRefusal::kError))];
    report.last_error = job.error;
  }
  if (answer.status == LocalizationStatus::kLocalized) {
    ++report.localized;
  } else {
    ++report.rejected[std::string(name(answer.status))];
  }
  report.optimize_ms.add(optimize_ms);
  report.matches.add(job.session->diagnostics().matches);
  report.memory_bytes = job.session->memory_bytes();
  if (report.memory_bytes > config_.max_session_bytes) {
    refuse(job.robot, PoolRefusal::kTooMuchMemory);
    return end(job.robot, "needs too much memory");
  }
  answer.robot = job.robot;
  answer.session = robot.session->session;
  answer.localizer = name_;
  answer.incarnation = incarnation_;
  answer.map_hash = map_->info().hash;
  answer.holding_time = now - job.received;
  robot.correction = job.correction;
  if (robot.correction) {
    robot.correction->robot = answer.robot;
    robot.correction->session = answer.session;
    robot.correction->localizer = answer.localizer;
    robot.correction->incarnation = answer.incarnation;
  }
  robot.answer = std::move(answer);
  robot.unsent = true;
}

std::vector<LocalizerPool::Outgoing> LocalizerPool::outgoing(Timestamp now, double load) {
  remove_expired(now);
  std::vector<Outgoing> messages;
  add_answers(messages, now);
  add_session_requests(messages);
  if (!status_sent_ || to_seconds(now - *status_sent_) >= config_.status_interval_s) {
    status_sent_ = now;
    messages.push_back({"", {Topic::kLocalizerStatus, encode(status(load))}});
  }
  return messages;
}

void LocalizerPool::add_answers(std::vector<Outgoing>& messages, Timestamp now) {
  for (auto& [id, robot] : robots_) {
    if (!robot.answer) continue;
    if (!robot.unsent && !robot.retransmission.due(now, robot.receiver.loss())) continue;
    robot.answer->acknowledgements = robot.receiver.acknowledgements();
    if (robot.unsent) robot.retransmission.sent(now);
    robot.unsent = false;
    try {
      messages.push_back({id, {Topic::kLocalization, encode(*robot.answer)}});
    } catch (const NotEncodable&) {  // a solution beyond all bounds harms only its own robot
      robot.answer.reset();
      refuse(id, PoolRefusal::kNotEncodable);
    }
    send_correction(id, robot, messages);
  }
}

// Once: a lost one is made up for by the next.
void LocalizerPool::send_correction(const RobotId& id,
                                    Robot& robot,
                                    std::vector<Outgoing>& messages) {
  if (!robot.correction) return;
  try {
    messages.push_back({id, {Topic::kCorrection, encode(*robot.correction)}});
  } catch (const NotEncodable&) {
    refuse(id, PoolRefusal::kCorrectionNotEncodable);
  }
  robot.correction.reset();
}

LocalizerStatus LocalizerPool::status(double load) const {
  return {.localizer = name_,
          .incarnation = incarnation_,
          .map_hash = map_->info().hash,
          .sessions = static_cast<int>(robots_.size()),
          .load = std::clamp(load, 0.0, 1.0),
          .accepting = robots_.size() < config_.max_sessions};
}

}  // namespace fleetloc
