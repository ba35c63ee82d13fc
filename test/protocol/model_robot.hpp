#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "robot/cloud_client/cloud_client.hpp"
#include "test/protocol/disturbed_network.hpp"
#include "test/protocol/sent_record.hpp"
#include "test/protocol/stream_model.hpp"

namespace fleetloc {

/// A robot whose odometry makes keyframes at random, with its real end of the protocol. It can be
/// restarted, lose its odometry, and have its clock set. After each step it checks what it sends
/// and gets, and throws Violation.
class ModelRobot {
 public:
  ModelRobot(RobotId id,
             DisturbedNetwork& network,
             SentRecord& record,
             const CloudClient::Config& config,
             std::uint32_t seed);
  ~ModelRobot();

  void step(Timestamp true_time);
  void restart();
  void reset_odometry();
  void step_clock(Duration by) { clock_offset_ += by; }

  /// A sample of the present stream and a localizer's answer, with numbers that are far ahead.
  [[nodiscard]] std::optional<std::pair<std::string, Message>> forged_sample(std::uint32_t ahead);
  [[nodiscard]] std::optional<Message> forged_answer(std::uint32_t ahead) const;

  /// Somebody sends a sample with a number far ahead before the first one of a session, sometimes.
  bool forges_first_samples = false;

  [[nodiscard]] const RobotId& id() const { return id_; }
  [[nodiscard]] SessionKey session() const { return {id_, session_.session}; }
  [[nodiscard]] CloudClient::Statistics statistics() const { return client_->statistics(); }
  /// Oldest first, as many as the cloud's window has.
  [[nodiscard]] const std::deque<SubmapKeyframe>& keyframes() const { return keyframes_; }
  /// How many keyframes are newer than that of the newest answer; all, if there is none.
  [[nodiscard]] std::size_t unanswered() const;
  [[nodiscard]] double moving_for_s() const { return to_seconds(true_time_ - moving_since_); }
  /// What the last restart has set free: what the client has held on the heap.
  [[nodiscard]] std::size_t freed_bytes() const { return freed_bytes_; }

 private:
  class Tap;
  /// To one incarnation of a localizer; beside it there may be that to a successor.
  struct Stream {
    Incarnation incarnation{};
    SessionNumber session{};
    StreamModel model;
    Timestamp idle_since{};  // connected, with a keyframe that is missing, and silent
  };

  void add_keyframe();
  void submit();
  void sent(const std::string& localizer, const Message& message);
  void received(const Message& message);
  void take_answers();
  void announced(const std::string& localizer, const RobotSession& session);
  void check_repetition(const StreamModel& stream, const Submap& sample) const;
  void check_is_not_idle();
  double uniform() { return std::uniform_real_distribution<double>()(random_); }

  RobotId id_;
  DisturbedNetwork& network_;
  SentRecord& record_;
  CloudClient::Config config_;
  std::mt19937 random_;
  std::unique_ptr<Channel> channel_;
  std::unique_ptr<CloudClient> client_;
  RobotSession session_;
  Timestamp true_time_{};
  Duration clock_offset_{};
  std::deque<SubmapKeyframe> keyframes_;
  std::deque<VirtualEdge> edges_;  // into keyframes_
  std::uint32_t next_keyframe_ = 0;
  Timestamp next_keyframe_at_{};
  Timestamp moving_since_{};
  std::map<std::string, Stream> streams_;  // by localizer
  std::optional<std::pair<std::string, Message>> last_sample_;
  std::optional<Message> last_answer_;
  std::size_t freed_bytes_ = 0;
  std::optional<KeyframeId> answered_;
  std::set<std::tuple<std::string, Incarnation, KeyframeId, Revision, LocalizationStatus>> answers_;
};

}  // namespace fleetloc
