#include "cloud/pool/session_protocol.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "shared/config/config_reader.hpp"
#include "shared/wire/status_codec.hpp"

namespace fleetloc {
namespace {

constexpr std::size_t kMaxUnknownRobots = 256;
constexpr double kForgetUnknownRobotSeconds = 10.0;
constexpr std::size_t kRequestBytes = 1200;

bool is_same(const std::optional<MapOdomEstimate>& a, const std::optional<MapOdomEstimate>& b) {
  if (!a || !b) return !a && !b;
  return a->T_map_odom.R.coeffs() == b->T_map_odom.R.coeffs() &&
         a->T_map_odom.p == b->T_map_odom.p && a->covariance == b->covariance &&
         a->p_odom == b->p_odom;
}

// Enough for a robot to choose by; a load changes a little all the time.
bool has_changed(const LocalizerStatus& before, const LocalizerStatus& now) {
  constexpr double kLoadStep = 0.1;
  return before.accepting != now.accepting || before.draining != now.draining ||
         before.sessions != now.sessions || std::abs(before.load - now.load) >= kLoadStep;
}

SessionProtocol::Draining read_draining_config(ConfigReader config) {
  return {.max_s = config.positive("max_s"),
          .silence_s = config.positive("silence_s"),
          .status = read_status_timer_config(config.section("status"))};
}

// The register may have forgotten a robot that is served here: what it does not know is no reason
// to refuse.
expected<void, PoolRefusal> not_superseded(const SessionRegister::Acceptance& accepted) {
  if (accepted || accepted.error() == SessionRefusal::kUnknown) return {};
  return unexpected(accepted.error() == SessionRefusal::kConflict ? PoolRefusal::kConflictingSession
                                                                  : PoolRefusal::kOutdatedSession);
}

}  // namespace

SessionProtocol::SessionProtocol(Identity identity, const Config& config)
    : identity_(std::move(identity)),
      config_(config),
      register_(config.sessions),
      admission_(config.admission),
      status_timer_(config.status) {}

expected<SessionProtocol::Change, PoolRefusal> SessionProtocol::announced(
    const RobotSession& session, Timestamp now) {
  if (const auto current = not_superseded(register_.announced(session, now)); !current)
    return unexpected(current.error());
  if (session.localizer != identity_.name) {
    if (sessions_.contains(session.robot)) return Change::kLeft;
    expected_.push_back(session.robot);
    return Change::kNone;
  }
  if (session.incarnation != identity_.incarnation) {
    return unexpected(PoolRefusal::kOtherIncarnation);
  }
  return open(session, now);
}

expected<SessionProtocol::Change, PoolRefusal> SessionProtocol::open(const RobotSession& session,
                                                                     Timestamp now) {
  const auto known = sessions_.find(session.robot);
  if (known == sessions_.end()) {
    if (sessions_.size() >= config_.max_sessions) return unexpected(PoolRefusal::kTooManySessions);
    sessions_.emplace(session.robot,
                      Session{.announced = session,
                              .receiver = {},
                              .answers = AnswerSender(config_.answers, last_number_),
                              .opened = now,
                              .last_message = now});
    unknown_robots_.erase(session.robot);
    expected_.push_back(session.robot);
    return Change::kOpened;
  }
  known->second.last_message = now;
  const RobotSession& current = known->second.announced;
  if (current.session == session.session && current.start_stamp == session.start_stamp) {
    return adopt_newer_start(session, known->second);
  }
  known->second.announced = session;
  known->second.receiver = {};
  known->second.answers.reset();
  return Change::kReplaced;
}

// While the robot is localized here, the localizer's pose is better than the robot's new start
// pose.
SessionProtocol::Change SessionProtocol::adopt_newer_start(const RobotSession& session,
                                                           Session& known) {
  if (known.answers.is_localized() || !session.start ||
      is_same(session.start, known.announced.start)) {
    return Change::kNone;
  }
  known.announced = session;
  known.answers.reset();
  return Change::kNewStart;
}

expected<const RobotSession*, PoolRefusal> SessionProtocol::submap(const SubmapHeader& submap,
                                                                   Timestamp now) {
  if (const auto current = not_superseded(register_.submap(submap.robot, submap.session, now));
      !current)
    return unexpected(current.error());
  const auto known = sessions_.find(submap.robot);
  if (submap.incarnation != identity_.incarnation) {
    request_session(submap, now);
    return unexpected(PoolRefusal::kOtherIncarnation);
  }
  if (known == sessions_.end() || known->second.announced.session != submap.session) {
    request_session(submap, now);
    return unexpected(PoolRefusal::kUnknownSession);
  }
  Session& session = known->second;
  session.last_message = now;
  if (!session.receiver.is_new(submap.number)) return unexpected(PoolRefusal::kSeenBefore);
  return &session.announced;
}

void SessionProtocol::note(const RobotId& robot, const AnswerReceipt& receipt, Timestamp now) {
  sessions_.at(robot).answers.note(receipt, now);
}

void SessionProtocol::store(const SubmapHeader& submap, Timestamp now) {
  sessions_.at(submap.robot).receiver.store(submap.number, now);
}

expected<void, PoolRefusal> SessionProtocol::status(const RobotStatus& status, Timestamp now) {
  const auto accepted = register_.status(status, now);
  if (const auto current = not_superseded(accepted); !current) return unexpected(current.error());
  const auto known = sessions_.find(status.robot);
  if (!accepted || known == sessions_.end()) return unexpected(PoolRefusal::kUnknownSession);
  known->second.last_message = now;
  return {};
}

// Sent to the robot's own topic; the keyframe proves that the request answers its submap.
void SessionProtocol::request_session(const SubmapHeader& submap, Timestamp now) {
  if (!sessions_.contains(submap.robot) && sessions_.size() >= config_.max_sessions) return;
  const auto known = unknown_robots_.find(submap.robot);
  if (known == unknown_robots_.end()
          ? unknown_robots_.size() >= kMaxUnknownRobots
          : to_seconds(now - known->second.requested) < config_.session_request_interval_s) {
    return;
  }
  LocalizationResult answer;
  answer.robot = submap.robot;
  answer.session = submap.session;
  answer.localizer = identity_.name;
  answer.incarnation = identity_.incarnation;
  answer.status = LocalizationStatus::kNeedFull;
  answer.keyframe = submap.keyframe;
  answer.revision = submap.revision;
  answer.stamp = submap.stamp;
  answer.map_hash = identity_.map_hash;
  unknown_robots_[submap.robot] = {.requested = now, .unsent = std::move(answer)};
}

void SessionProtocol::answer(const RobotId& robot,
                             LocalizationResult answer,
                             std::optional<Correction> correction) {
  Session& session = sessions_.at(robot);
  answer.robot = robot;
  answer.session = session.announced.session;
  answer.localizer = identity_.name;
  answer.incarnation = identity_.incarnation;
  answer.map_hash = identity_.map_hash;
  if (correction) {
    correction->robot = answer.robot;
    correction->session = answer.session;
    correction->localizer = answer.localizer;
    correction->incarnation = answer.incarnation;
  }
  session.answers.set({std::move(answer), std::move(correction)});
}

std::vector<OutgoingMessage> SessionProtocol::outgoing(Timestamp now,
                                                       double load,
                                                       PoolReport& report) {
  std::vector<OutgoingMessage> messages;
  add_answers(messages, now, report);
  add_session_requests(messages);
  status_ = measured_status(load, now);
  if (status_timer_.due(now, has_changed(sent_status_, status_))) {
    sent_status_ = status_;
    messages.push_back({"", {Topic::kLocalizerStatus, encode(status_)}});
  }
  return messages;
}

void SessionProtocol::add_answers(std::vector<OutgoingMessage>& messages,
                                  Timestamp now,
                                  PoolReport& report) {
  for (auto& [robot, session] : sessions_) {
    auto message = session.answers.due(session.receiver, now);
    if (!message) continue;
    if (*message) {
      messages.push_back({robot, **std::move(message)});
    } else {
      report.refuse(robot, message->error(), now);
    }
  }
}

void SessionProtocol::add_session_requests(std::vector<OutgoingMessage>& messages) {
  for (auto& [id, unknown_robot] : unknown_robots_) {
    if (!unknown_robot.unsent) continue;
    messages.push_back(
        {id, {Topic::kLocalization, encode({*unknown_robot.unsent, std::nullopt}, kRequestBytes)}});
    unknown_robot.unsent.reset();
  }
}

LocalizerStatus SessionProtocol::measured_status(double load, Timestamp now) {
  const auto is_new = [&](const auto& item) { return admission_.is_new(item.second.opened, now); };
  const Admission::Sessions sessions{
      .all = static_cast<int>(sessions_.size()),
      .fresh = static_cast<int>(std::ranges::count_if(sessions_, is_new))};
  const bool is_open = admission_.update(load, sessions, now);
  return {.localizer = identity_.name,
          .incarnation = identity_.incarnation,
          .map_hash = identity_.map_hash,
          .sessions = sessions.all,
          .load = std::clamp(load, 0.0, 1.0),
          .accepting = is_open && !draining_since_ && sessions_.size() < config_.max_sessions,
          .draining = draining_since_.has_value()};
}

void SessionProtocol::drain(Timestamp now) {
  if (draining_since_) return;
  draining_since_ = now;
  status_timer_ = StatusTimer(config_.draining.status);
}

std::vector<RobotId> SessionProtocol::to_leave(Timestamp now) const {
  std::vector<RobotId> robots;
  if (!draining_since_ || to_seconds(now - *draining_since_) > config_.draining.max_s)
    return robots;
  for (const auto& [robot, session] : sessions_) {
    if (to_seconds(now - session.last_message) <= config_.draining.silence_s) {
      robots.push_back(robot);
    }
  }
  return robots;
}

Timestamp SessionProtocol::end(const RobotId& robot) {
  const auto session = sessions_.extract(robot);
  last_number_ = std::max(last_number_, session.mapped().answers.number());
  return session.mapped().last_message;
}

std::vector<RobotId> SessionProtocol::idle(Timestamp now) const {
  std::vector<RobotId> idle;
  for (const auto& [robot, session] : sessions_) {
    if (to_seconds(now - session.last_message) > config_.idle_session_s) idle.push_back(robot);
  }
  return idle;
}

void SessionProtocol::clean_up(Timestamp now) {
  std::erase_if(unknown_robots_, [&](const auto& item) {
    return to_seconds(now - item.second.requested) > kForgetUnknownRobotSeconds;
  });
}

std::vector<RobotId> SessionProtocol::take_expected() {
  return std::exchange(expected_, {});
}

SessionProtocol::Config read_session_protocol_config(ConfigReader pool) {
  return {.max_sessions = static_cast<std::size_t>(pool.integer("max_sessions", 1, 100'000)),
          .idle_session_s = pool.positive("idle_session_s"),
          .session_request_interval_s = pool.positive("session_request_interval_s"),
          .status = read_status_timer_config(pool.section("status")),
          .answers = read_answer_sender_config(pool.section("answers")),
          .sessions = read_session_register_config(pool.section("sessions")),
          .admission = read_admission_config(pool.section("admission")),
          .draining = read_draining_config(pool.section("draining"))};
}

}  // namespace fleetloc
