#include "test/protocol/model_robot.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <malloc.h>

#include "shared/compact/answer_sample.hpp"
#include "shared/compact/submap_sample.hpp"
#include "shared/wire/session_codec.hpp"
#include "test/protocol/violation.hpp"

namespace fleetloc {
namespace {

constexpr std::size_t kWindow = 10;   // keyframes of the odometry
constexpr std::size_t kHorizon = 40;  // of the cloud's window
constexpr std::size_t kHelpful = 38;  // of them are sent again if they were lost
constexpr double kLongestSilenceSeconds = 8.0;
constexpr std::uint32_t kLandmarksPerKeyframe = 3;  // new ones
constexpr std::uint32_t kLandmarkLife = 5;          // keyframes

}  // namespace

/// Shows the robot's messages to the model.
class ModelRobot::Tap final : public Channel {
 public:
  Tap(ModelRobot& robot, std::unique_ptr<Channel> whole)
      : robot_(robot), whole_(std::move(whole)) {}

  void send(const std::string& partition, Message message, Timestamp now) override {
    robot_.sent(partition, message);
    whole_->send(partition, std::move(message), now);
  }
  [[nodiscard]] std::vector<Message> receive(Timestamp now) override {
    auto messages = whole_->receive(now);
    for (const Message& message : messages) robot_.received(message);
    return messages;
  }
  void release(const std::string& partition) override { whole_->release(partition); }
  [[nodiscard]] ChannelStatistics statistics() const override { return {}; }

 private:
  ModelRobot& robot_;
  std::unique_ptr<Channel> whole_;
};

ModelRobot::ModelRobot(RobotId id,
                       DisturbedNetwork& network,
                       SentRecord& record,
                       const CloudClient::Config& config,
                       std::uint32_t seed)
    : id_(std::move(id)), network_(network), record_(record), config_(config), random_(seed) {
  session_.robot = id_;
  session_.stereo = {.focal_px = 458.0,
                     .center_px = {1024.0, 1024.0},
                     .baseline_m = 0.1 + 0.05 * uniform(),
                     .T_body_cam0 = {}};
}

ModelRobot::~ModelRobot() = default;

void ModelRobot::restart() {
  const std::size_t before = mallinfo2().uordblks;
  client_.reset();
  freed_bytes_ = before - std::min<std::size_t>(before, mallinfo2().uordblks);
  channel_ = std::make_unique<Tap>(*this, network_.join(true, id_));
  client_ = std::make_unique<CloudClient>(id_, *channel_, config_);
  const Timestamp now = true_time_ + clock_offset_;
  session_.start_stamp = now;
  const std::int64_t milliseconds = now.time_since_epoch().count() / 1'000'000;
  session_.session = SessionNumber{static_cast<std::uint32_t>(milliseconds)};
  reset_odometry();
}

void ModelRobot::reset_odometry() {
  session_.session = SessionNumber{static_cast<std::uint32_t>(session_.session) + 1};
  if (uniform() < 0.7) {
    session_.start = MapOdomEstimate{.T_map_odom = {}, .covariance = 0.01 * Matrix6d::Identity()};
  } else {
    session_.start.reset();
  }
  keyframes_.clear();
  edges_.clear();
  streams_.clear();
  last_sample_.reset();
  last_answer_.reset();
  answered_.reset();
  answers_.clear();
  client_->start_session(session_, true_time_ + clock_offset_);
}

void ModelRobot::step(Timestamp true_time) {
  true_time_ = true_time;
  if (!client_) restart();
  const Timestamp now = true_time_ + clock_offset_;
  client_->update(now, uniform() < 0.001 ? Quality::kLost : Quality::kLocalized);
  if (true_time_ >= next_keyframe_at_) {
    next_keyframe_at_ = true_time_ + from_seconds(0.25 + 0.35 * uniform());
    if (uniform() < 0.003) {  // stands still
      next_keyframe_at_ += from_seconds(20.0 * uniform());
      moving_since_ = next_keyframe_at_;
    }
    add_keyframe();
    submit();
  }
  take_answers();
  static_cast<void>(client_->take_correction());
  static_cast<void>(client_->take_events());
  check_is_not_idle();
}

// A landmark is seen by some keyframes in a row. The last one of them is complete later.
void ModelRobot::add_keyframe() {
  const std::uint32_t id = next_keyframe_++;
  SubmapKeyframe keyframe;
  keyframe.id = KeyframeId{id};
  keyframe.revision = Revision{1};
  keyframe.stamp = true_time_ + clock_offset_;
  keyframe.tilt_sigma = 0.003 + 0.01 * uniform();
  if (!keyframes_.empty()) keyframe.T_odom_body = keyframes_.back().T_odom_body;
  const Eigen::Vector3d turn(0.02 * uniform(), 0.02 * uniform(), 0.2 * uniform() - 0.1);
  keyframe.T_odom_body.R *= Eigen::Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
  keyframe.T_odom_body.p += Eigen::Vector3d(uniform() - 0.3, uniform() - 0.5, 0.1 * uniform());
  const std::uint32_t newest = kLandmarksPerKeyframe * (id + kLandmarkLife);
  for (std::uint32_t i = kLandmarksPerKeyframe * id; i < newest; ++i) {
    const double age = static_cast<double>(newest - i);
    keyframe.observations.push_back(
        {.landmark = LandmarkId{i},
         .left = {800.0 + 37.0 * (i % 11) + 4.0 * age + uniform(), 900.0 + 29.0 * (i % 7)},
         .disparity = i % 5 == 0 ? 0.0 : 5.0 + i % 13 + uniform()});
  }
  if (!keyframes_.empty()) {
    const SubmapKeyframe& from = keyframes_.back();
    Vector6d information;
    information << Eigen::Vector3d::Constant(1e6 + 1e7 * uniform()), 4e4, 4e4,
        9e4 * uniform() + 1.0;
    edges_.push_back({.from = from.id,
                      .to = keyframe.id,
                      .revision = Revision{1},
                      .T_from_to = inverse(from.T_odom_body) * keyframe.T_odom_body,
                      .information = information.asDiagonal()});
  }
  keyframes_.push_back(std::move(keyframe));
  if (keyframes_.size() > kHorizon) keyframes_.pop_front();
  while (!edges_.empty() && edges_.front().from < keyframes_.front().id) edges_.pop_front();
  if (edges_.size() >= kWindow - 1) edges_[edges_.size() - (kWindow - 1)].is_final = true;
  for (auto& [name, stream] : streams_) stream.model.forget_before(keyframes_.front().id);
}

// Of the newest keyframe a third of the observations is found later.
void ModelRobot::submit() {
  Submap window;
  for (std::size_t i = keyframes_.size() - std::min(keyframes_.size(), kWindow);
       i < keyframes_.size();
       ++i) {
    window.keyframes.push_back(keyframes_[i]);
  }
  std::erase_if(window.keyframes.back().observations, [](const StereoObservation& one) {
    return static_cast<std::uint32_t>(one.landmark) % 3 == 0;
  });
  for (const VirtualEdge& edge : edges_) {
    if (edge.from >= window.keyframes.front().id) window.edges.push_back(edge);
  }
  const Timestamp now = true_time_ + clock_offset_;
  if (answered_) {
    MapOdomEstimate start;
    start.T_map_odom.p.x() = uniform();
    client_->update_start(start);
  }
  client_->submit(std::move(window), now);
}

// The session announces a stream to the localizer that it names, and ends that to any other one.
void ModelRobot::announced(const std::string& localizer, const RobotSession& session) {
  if (session.localizer != localizer) {
    streams_.erase(localizer);
    return;
  }
  const auto known = streams_.find(localizer);
  if (known != streams_.end() && known->second.incarnation == session.incarnation &&
      known->second.session == session.session) {
    return;
  }
  streams_[localizer] = {.incarnation = session.incarnation,
                         .session = session.session,
                         .model = {},
                         .idle_since = true_time_};
}

void ModelRobot::sent(const std::string& localizer, const Message& message) {
  if (message.topic == Topic::kSession) {
    announced(localizer, decode_robot_session(message.payload).value());
  }
  if (message.topic != Topic::kCompactSubmap) return;
  expect(message.payload.size() <= config_.stream.uplink.max_payload_bytes,
         "a sample is too large");
  const Submap& sample = record_.add(message.payload, session_.stereo);
  const auto stream = streams_.find(localizer);
  expect(stream != streams_.end() && stream->second.incarnation == sample.incarnation &&
             stream->second.session == sample.session,
         id_ + ": a sample of a stream that " + localizer + " was not told of");
  check_repetition(stream->second.model, sample);
  stream->second.model.sent(sample);
  stream->second.idle_since = true_time_;
  const bool is_first = !last_sample_;
  last_sample_ = {localizer, message};
  if (is_first && forges_first_samples && uniform() < 0.2) {
    network_.inject(false, localizer, forged_sample(1'000'000)->second);
  }
}

void ModelRobot::received(const Message& message) {
  if (message.topic != Topic::kLocalization) return;
  const auto answer = decode_answer(message.payload);
  if (!answer) return;
  const LocalizationResult& result = answer->result;
  const auto stream = streams_.find(result.localizer);
  if (stream == streams_.end() || stream->second.incarnation != result.incarnation ||
      stream->second.session != result.session) {
    return;
  }
  if (result.status == LocalizationStatus::kNeedFull) return stream->second.model.lose_track();
  last_answer_ = message;
  stream->second.model.acknowledged(result.acknowledgements);
}

void ModelRobot::take_answers() {
  for (const LocalizationResult& answer : client_->take_answers(true_time_ + clock_offset_)) {
    expect(answer.robot == id_ && answer.session == session_.session,
           id_ + ": got an answer to another session");
    const std::tuple identity(
        answer.localizer, answer.incarnation, answer.keyframe, answer.revision, answer.status);
    expect(answers_.insert(identity).second, id_ + ": got an answer twice");
    if (!answered_ || *answered_ < answer.keyframe) answered_ = answer.keyframe;
    if (answer.status == LocalizationStatus::kLocalized) client_->note_applied();
  }
  while (answers_.size() > 1000) answers_.erase(answers_.begin());
}

// What is certainly missing goes before what may have arrived.
void ModelRobot::check_repetition(const StreamModel& stream, const Submap& sample) const {
  if (keyframes_.empty() || sample.keyframes.back().id == keyframes_.back().id) return;
  if (std::ranges::any_of(sample.keyframes,
                          [&](const auto& one) { return stream.may_be_missing(one.id); })) {
    return;
  }
  for (std::size_t age = 1; age < std::min(kHelpful, keyframes_.size()); ++age) {
    const KeyframeId id = keyframes_[keyframes_.size() - 1 - age].id;
    expect(!stream.is_missing(id),
           id_ + ": a datagram repeats what may be there, and keyframe " +
               std::to_string(static_cast<std::uint32_t>(id)) + " is certainly missing");
  }
}

void ModelRobot::check_is_not_idle() {
  for (auto& [name, stream] : streams_) {
    bool is_missing = false;
    for (std::size_t age = 0; age < std::min(kHelpful, keyframes_.size()); ++age) {
      is_missing |= stream.model.is_missing(keyframes_[keyframes_.size() - 1 - age].id);
    }
    if (!is_missing) stream.idle_since = true_time_;
    expect(to_seconds(true_time_ - stream.idle_since) < kLongestSilenceSeconds,
           id_ + ": a keyframe is certainly missing, and nothing is sent to " + name);
  }
}

std::size_t ModelRobot::unanswered() const {
  return static_cast<std::size_t>(std::ranges::count_if(
      keyframes_, [&](const auto& keyframe) { return !answered_ || keyframe.id > *answered_; }));
}

// The number follows the robot's id, session and incarnation in the CDR.
std::optional<std::pair<std::string, Message>> ModelRobot::forged_sample(std::uint32_t ahead) {
  if (!last_sample_) return std::nullopt;
  auto forged = *last_sample_;
  const std::size_t id_end = 4 + 4 + (id_.size() + 1 + 3) / 4 * 4;
  const std::uint32_t number =
      static_cast<std::uint32_t>(decode_submap_sample(forged.second.payload).value().number) +
      ahead;
  std::memcpy(forged.second.payload.data() + id_end + 8, &number, sizeof number);
  record_.add(forged.second.payload, session_.stereo);
  return forged;
}

std::optional<Message> ModelRobot::forged_answer(std::uint32_t ahead) const {
  if (!last_answer_) return std::nullopt;
  Answer answer = decode_answer(last_answer_->payload).value();
  answer.result.number += ahead;
  answer.result.acknowledgements.base =
      SampleNumber{static_cast<std::uint32_t>(answer.result.acknowledgements.base) + ahead};
  return Message{Topic::kLocalization, encode(answer, 1200)};
}

}  // namespace fleetloc
