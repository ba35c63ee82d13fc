#include "test/protocol/model_localizer.hpp"

#include <utility>

#include "shared/compact/answer_sample.hpp"
#include "test/protocol/violation.hpp"

namespace fleetloc {
namespace {

constexpr std::size_t kWorkers = 2;

}  // namespace

ModelLocalizer::ModelLocalizer(std::string name,
                               Incarnation incarnation,
                               std::shared_ptr<const LaserMap> map,
                               const LocalizerPool::Config& config,
                               DisturbedNetwork& network,
                               SentRecord& record,
                               std::uint32_t seed)
    : name_(std::move(name)),
      incarnation_(incarnation),
      record_(record),
      random_(seed),
      channel_(network.join(false, name_)),
      pool_(name_, incarnation, std::move(map), config) {}

void ModelLocalizer::step(Timestamp now) {
  if (now < paused_until_) return;
  for (const Message& message : channel_->receive(now)) pool_.receive(message, now);
  static_cast<void>(pool_.take_expected());
  static_cast<void>(pool_.take_events());
  while (!running_.empty() && running_.begin()->first <= now) {
    Running done = std::move(running_.extract(running_.begin()).mapped());
    pool_.finish(done.job, std::move(done.answer), 1.0, now);
  }
  while (running_.size() < kWorkers) {
    auto job = pool_.take_job(now);
    if (!job) break;
    LocalizationResult answer = run(*job);
    const double time_s = 2.0 * job_time_s_ * uniform();
    running_.emplace(now + from_seconds(time_s), Running{*std::move(job), std::move(answer)});
  }
  for (auto& outgoing : pool_.outgoing(now, 0.2 * static_cast<double>(running_.size()))) {
    if (outgoing.message.topic == Topic::kLocalization) {
      check_acknowledgements(decode_answer(outgoing.message.payload).value().result);
    }
    channel_->send(outgoing.partition, std::move(outgoing.message), now);
  }
}

// As LocalizerPool::run, but for the estimation.
LocalizationResult ModelLocalizer::run(LocalizerPool::Job& job) {
  LocalizerPool::take_over(job);
  check_database(job);
  const SubmapKeyframe& newest = job.session->database().newest().item;
  LocalizationResult answer;
  answer.status =
      uniform() < 0.9 ? LocalizationStatus::kLocalized : LocalizationStatus::kTooFewMatches;
  answer.keyframe = newest.id;
  answer.revision = newest.revision;
  answer.stamp = newest.stamp;
  answer.oldest_stamp = newest.stamp;
  answer.covariance = 1e-4 * Matrix6d::Identity();
  if (answer.status == LocalizationStatus::kLocalized && uniform() < 0.5) {
    job.correction.emplace().anchor = newest.id;
    job.correction->landmarks.push_back(
        {LandmarkId{1}, {1.0, 2.0, 3.0}, Eigen::Matrix3d::Identity()});
  }
  return answer;
}

void ModelLocalizer::check_database(const LocalizerPool::Job& job) {
  const SessionKey key{job.robot, job.submaps.front().session};
  const std::string where = name_ + ", " + job.robot + ": ";
  Stream& stream = streams_[job.robot];
  if (stream.localizer != job.session) {
    const bool is_taken_over = job.predecessor && job.predecessor == stream.localizer;
    if (!is_taken_over) {
      stream.lost = stream.session == key ? std::move(stream.stored) : std::set<std::uint32_t>{};
      stream.stored.clear();
      stream.claimed.clear();
    }
    stream.localizer = job.session;
    stream.session = key;
  }
  expect(stream.session == key, where + "two sessions in one database");
  const SessionDatabase& database = job.session->database();
  expect(database.keyframes().size() <= 40, where + "too many keyframes");
  expect(database.spanning_edges().size() < 40, where + "too many edges");
  std::string violation = record_.check_origin(database, key, incarnation_);
  for (const Submap& submap : job.submaps) {
    const SessionKey of{submap.robot, submap.session};
    expect(of == key, where + "a sample of another session");
    stream.stored.insert(static_cast<std::uint32_t>(submap.number));
    stream.claimed.erase(static_cast<std::uint32_t>(submap.number));
    if (violation.empty()) violation = record_.check_stored(database, submap);
  }
  expect(violation.empty(), where + violation);
  expect(stream.claimed.empty(),
         where + "a sample is acknowledged and neither in the database nor in this job");
  while (stream.stored.size() > 4096) stream.stored.erase(stream.stored.begin());
}

void ModelLocalizer::check_acknowledgements(const LocalizationResult& answer) {
  const auto found = streams_.find(answer.robot);
  if (found == streams_.end() || found->second.session.session != answer.session) return;
  Stream& stream = found->second;
  for (std::uint32_t bit = 0; bit < 64; ++bit) {
    if (((answer.acknowledgements.bitmap >> bit) & 1U) == 0) continue;
    const std::uint32_t number = static_cast<std::uint32_t>(answer.acknowledgements.base) + bit;
    if (stream.stored.contains(number)) continue;
    expect(!stream.lost.contains(number),
           name_ + ", " + answer.robot + ": sample " + std::to_string(number) +
               " is acknowledged and lost with its database");
    stream.claimed.insert(number);
  }
}

const SessionDatabase* ModelLocalizer::database(const SessionKey& session) const {
  const auto stream = streams_.find(session.robot);
  if (stream == streams_.end() || stream->second.session != session) return nullptr;
  return &stream->second.localizer->database();
}

}  // namespace fleetloc
