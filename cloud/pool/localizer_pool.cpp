#include "cloud/pool/localizer_pool.hpp"

#include <utility>

#include "shared/config/config_reader.hpp"
#include "shared/wire/session_codec.hpp"
#include "shared/wire/status_codec.hpp"
#include "shared/wire/submap_codec.hpp"

namespace fleetloc {
namespace {

constexpr double kCleanUpSeconds = 1.0;

/// After a turn of the session that took so long. One with new submaps was spent on their
/// localization, but for a part of a search.
void note_search(const LocalizerPool::Job& job, double turn_ms, SearchReport& report) {
  const FirstPlace* const search = job.session->first_place();
  if (!search) return;
  if (job.submaps.empty()) report.running_ms += turn_ms;
  if (search->is_running()) return;
  const double run_ms = std::exchange(report.running_ms, 0.0);
  if (search->searches() != report.searches) report.ms.add(run_ms);
  report.searches = search->searches();
  report.explained = search->explained();
  report.places_left = search->places_left();
}

std::vector<Eigen::Vector3d> possible_places_of(const SessionLocalizer& session) {
  std::vector<Eigen::Vector3d> places;
  for (const auto& place : session.possible_places()) places.push_back(place.T_map_body.p);
  return places;
}

void note(const LocalizerPool::Job& job,
          const LocalizationResult& answer,
          double optimize_ms,
          SessionReport& report) {
  if (!job.error.empty()) {
    report.last_error = job.error;
    ++report.rejected["error"];
  } else if (const auto rejection = job.session->diagnostics().rejection) {
    ++report.rejected[std::string(name(*rejection))];
  } else if (answer.status == LocalizationStatus::kLocalized) {
    ++report.localized;
  }
  report.optimize_ms.add(optimize_ms);
  report.matches.add(job.session->diagnostics().matches);
}

}  // namespace

LocalizerPool::LocalizerPool(std::string name,
                             Incarnation incarnation,
                             std::shared_ptr<const LaserMap> map,
                             const Config& config,
                             std::shared_ptr<const MapPyramid> pyramid,
                             MapRegions regions)
    : map_(std::move(map)),
      pyramid_(std::move(pyramid)),
      regions_(std::move(regions)),
      config_(config),
      writers_(config.protocol.sessions.silence_s),
      protocol_({.name = name, .incarnation = incarnation, .map_hash = map_->info().hash},
                config.protocol),
      scheduler_(config.max_waiting_s),
      report_(config.protocol.max_sessions),
      served_(name) {}

void LocalizerPool::receive(const Message& message, Timestamp now) {
  const auto take = [&](auto decoded, auto receive) {
    if (!decoded) return report_.refuse(decoded.error());
    if (is_of_its_writer(decoded->robot, message.sender, now)) receive(*std::move(decoded));
  };
  const Bytes& payload = message.payload;
  if (message.topic == Topic::kSession) {
    take(decode_robot_session(payload), [&](auto session) { receive_session(session, now); });
  } else if (message.topic == Topic::kSubmap) {
    take(decode_submap(payload),
         [&](auto submap) { receive_submap(std::move(submap), payload.size(), now); });
  } else if (message.topic == Topic::kCompactSubmap) {
    take(decode_submap_sample(payload),
         [&](const auto& sample) { receive_submap(sample, payload.size(), now); });
  } else if (message.topic == Topic::kRobotStatus) {
    take(decode_robot_status(payload),
         [&](auto status) { receive_status(status, payload.size(), now); });
  }
}

bool LocalizerPool::is_of_its_writer(const RobotId& robot,
                                     const MessageSender& sender,
                                     Timestamp now) {
  if (writers_.accepts(robot, sender, now)) return true;
  report_.refuse(robot, PoolRefusal::kForeignWriter, now);
  return false;
}

void LocalizerPool::receive_session(const RobotSession& session, Timestamp now) {
  using Change = SessionProtocol::Change;
  const auto change = protocol_.announced(session, now);
  if (!change) return report_.refuse(session.robot, change.error(), now);
  if (*change == Change::kLeft) return end(session.robot, "went to " + session.localizer);
  if (*change != Change::kNone) open(session, *change, now);
  if (*change == Change::kOpened || *change == Change::kReplaced) {
    for (const auto& [sample, bytes] : early_.take(session.robot, session.session)) {
      receive_submap(sample, bytes, now);
    }
  }
}

// A job that runs meanwhile keeps its own session; what it finds is dropped.
void LocalizerPool::open(const RobotSession& session,
                         SessionProtocol::Change change,
                         Timestamp now) {
  using Change = SessionProtocol::Change;
  Robot& robot = robots_[session.robot];
  const auto before =
      std::exchange(robot.localizer,
                    std::make_shared<SessionLocalizer>(
                        session, map_, config_.localizer, pyramid_, region_of(session)));
  if (change == Change::kOpened) report_.open(session.robot);
  report_.of(session.robot).search = {};
  if (change == Change::kNewStart) {  // the first of them has the data, unless it was taken over
    if (!robot.predecessor) robot.predecessor = before;
    return;
  }
  robot.predecessor.reset();
  robot.waiting.clear();
  scheduler_.drop_work(session.robot);
  ++report_.of(session.robot).sessions;
  served_.open(session.robot, session.session, now);
  report_.log(session.robot + ": session " +
              std::to_string(static_cast<std::uint32_t>(session.session)) +
              (change == Change::kReplaced ? " replaces the one before" : " opened"));
}

// Who began in a region that the map does not have is not searched for elsewhere: what looks like
// the place there may be one of another storey.
std::optional<MapRegion> LocalizerPool::region_of(const RobotSession& session) {
  if (!session.region) return std::nullopt;
  const StartRegion& region = *session.region;
  if (region.name.empty()) return MapRegion::circle(region.center_map, region.radius_m);
  const auto found = regions_.find(region.name);
  if (found != regions_.end()) return found->second;
  report_.log(session.robot + ": begins in region '" + region.name +
              "', which the map does not have: it is not searched for");
  return MapRegion::nowhere();
}

void LocalizerPool::receive_submap(Submap submap, std::size_t bytes, Timestamp now) {
  const auto accepted = protocol_.submap(header_of(submap), now);
  if (!accepted) return report_.refuse(submap.robot, accepted.error(), now);
  add_submap(std::move(submap), bytes, now);
}

// The block is decoded with the calibration of its session, so only when that is known.
void LocalizerPool::receive_submap(const SubmapSample& sample, std::size_t bytes, Timestamp now) {
  const auto accepted = protocol_.submap(header_of(sample), now);
  if (!accepted) {
    if (accepted.error() == PoolRefusal::kUnknownSession) early_.keep(sample, bytes, now);
    return report_.refuse(sample.robot, accepted.error(), now);
  }
  // What is acknowledged is not sent again, so none of it may be dropped to make room.
  if (!robots_.at(sample.robot).waiting.has_room(bytes, config_.waiting)) {
    return report_.refuse(sample.robot, PoolRefusal::kOvertaken, now);
  }
  auto submap = decode_submap(sample, (*accepted)->stereo);
  if (!submap) return report_.refuse(submap.error());
  protocol_.note(sample.robot, sample.receipt, now);
  add_submap(*std::move(submap), bytes, now);
}

void LocalizerPool::add_submap(Submap submap, std::size_t bytes, Timestamp now) {
  const RobotId id = submap.robot;
  protocol_.store(header_of(submap), now);
  served_.received(id, bytes, now);
  SessionReport& report = report_.of(id);
  ++report.submaps;
  scheduler_.add(id, now);
  const std::size_t overtaken =
      robots_.at(id).waiting.push(std::move(submap), bytes, now, config_.waiting);
  report.refuse(PoolRefusal::kOvertaken, overtaken);
}

// A status alone asks for nothing: that of an unknown session is not counted.
void LocalizerPool::receive_status(const RobotStatus& status, std::size_t bytes, Timestamp now) {
  const auto accepted = protocol_.status(status, now);
  if (accepted) {
    report_.of(status.robot).status = status;
    served_.received(status.robot, bytes, now);
    served_.told(status);
  } else if (accepted.error() != PoolRefusal::kUnknownSession) {
    report_.refuse(status.robot, accepted.error(), now);
  }
}

// Work that is dropped is the localization: the submaps were acknowledged.
std::optional<LocalizerPool::Job> LocalizerPool::take_job(Timestamp now) {
  for (const RobotId& robot : scheduler_.drop_stale(now)) {
    report_.of(robot).refuse(PoolRefusal::kStale, robots_.at(robot).waiting.set_aside());
  }
  const auto turn = scheduler_.take();
  if (!turn) return std::nullopt;
  Robot& robot = robots_.at(turn->robot);
  const Timestamp received = robot.waiting.oldest().value_or(now);
  protocol_.waited(now - received, now);
  return Job{.robot = turn->robot,
             .turn = turn->number,
             .received = received,
             .started = now,
             .session = robot.localizer,
             .predecessor = std::exchange(robot.predecessor, nullptr),
             .submaps = robot.waiting.take(),
             .round_trip = protocol_.round_trip(turn->robot),
             .correction = {},
             .error = {}};
}

void LocalizerPool::take_over(Job& job) {
  if (job.predecessor) job.session->take_over(job.predecessor->database());
  for (const Submap& submap : job.submaps) job.session->add(submap);
}

// An exception ends the job of one robot only.
LocalizationResult LocalizerPool::run(Job& job) {
  try {
    take_over(job);
    LocalizationResult answer = job.session->localize();
    job.correction = job.session->correction(job.round_trip);
    return answer;
  } catch (const std::exception& error) {
    job.error = error.what();
    const SubmapKeyframe& newest = job.submaps.empty() ? job.session->database().newest().item
                                                       : job.submaps.back().keyframes.back();
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
  scheduler_.finish({.robot = job.robot, .number = job.turn}, now - job.started);
  const auto found = robots_.find(job.robot);
  const bool is_current = found != robots_.end() && found->second.localizer == job.session;
  if (!is_current) return;  // the session was replaced meanwhile
  SessionReport& report = report_.of(job.robot);
  if (!job.error.empty()) report.refuse(PoolRefusal::kError);
  report.memory_bytes = job.session->memory_bytes();
  note_search(job, optimize_ms, report.search);
  report.search.possible_places = possible_places_of(*job.session);
  served_.searched(job.robot, report.search.possible_places);
  // A turn of a search that has found nothing has nothing new to say.
  const bool is_silent =
      job.submaps.empty() && job.error.empty() && answer.status != LocalizationStatus::kLocalized;
  if (!is_silent) note(job, answer, optimize_ms, report);
  if (report.memory_bytes > config_.max_session_bytes) {
    report.refuse(PoolRefusal::kTooMuchMemory);
    return end(job.robot, "needs too much memory");
  }
  if (job.error.empty() && job.session->is_searching()) scheduler_.add_background(job.robot);
  if (is_silent) return;
  served_.answered(job.robot, answer);
  protocol_.answer(job.robot, std::move(answer), job.correction);
}

std::vector<OutgoingMessage> LocalizerPool::outgoing(Timestamp now, double load) {
  clean_up(now);
  auto messages = protocol_.outgoing(now, load, report_);
  for (const OutgoingMessage& each : messages) {
    served_.sent(each.partition, each.message.payload.size(), now);
  }
  return messages;
}

void LocalizerPool::end(const RobotId& robot, const std::string& why) {
  report_.close(robot, why, protocol_.end(robot));
  served_.erase(robot);
  scheduler_.erase(robot);
  robots_.erase(robot);
}

void LocalizerPool::clean_up(Timestamp now) {
  if (cleaned_up_ && to_seconds(now - *cleaned_up_) < kCleanUpSeconds) return;
  cleaned_up_ = now;
  for (const RobotId& robot : protocol_.idle(now)) {
    if (!scheduler_.is_running(robot)) end(robot, "nothing was heard of the robot");
  }
  protocol_.clean_up(now);
  early_.clean_up(now);
  report_.clean_up(now);
}

LocalizerPool::Config read_localizer_pool_config(ConfigReader config) {
  ConfigReader pool = config.section("pool");
  const auto count = [&](const char* key, int max) {
    return static_cast<std::size_t>(pool.integer(key, 1, max));
  };
  return {.localizer = read_session_localizer_config(config.section("localizer")),
          .pyramid = read_pyramid_config(config.section("pyramid")),
          .protocol = read_session_protocol_config(pool),
          .waiting = {.max_submaps = count("max_waiting_submaps", 10'000),
                      .max_bytes = count("max_waiting_bytes", 1'000'000'000)},
          .max_waiting_s = pool.positive("max_waiting_s"),
          .max_session_bytes = count("max_session_bytes", 1'000'000'000)};
}

}  // namespace fleetloc
