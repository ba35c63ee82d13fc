#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "robot/cloud_client/answer_history.hpp"
#include "robot/cloud_client/localizer_connections.hpp"
#include "robot/cloud_client/localizer_events.hpp"
#include "robot/cloud_client/localizer_selector.hpp"
#include "robot/cloud_client/localizer_stream.hpp"
#include "robot/cloud_client/message_refusal.hpp"
#include "robot/cloud_client/session_streams.hpp"
#include "shared/core/expected.hpp"
#include "shared/link/channel.hpp"
#include "shared/model/map_localizer.hpp"
#include "shared/model/pose_estimate.hpp"
#include "shared/protocol/sender_binding.hpp"
#include "shared/protocol/status_timer.hpp"
#include "shared/protocol/steady_time.hpp"

namespace fleetloc {

class ConfigReader;

/// The robot's end of the protocol: selects a localizer, announces the session to it, sends submaps
/// and returns each answer once. When the localizer restarts or loses the session, the session is
/// announced again with the newest estimate of T_map_odom.
///
/// A handover to another localizer makes before it breaks: the successor is brought the session and
/// all keyframes that it can use, while the old one is sent what it always was and answers as long
/// as it can. With its first pose from about as long a window the successor takes over, and the old
/// one is told.
///
/// The robot's clock may be set meanwhile, forward or back.
///
/// From the first applied answer on, only localizers with that answer's map are used.
class CloudClient final : public MapLocalizer {
 public:
  struct Config {
    LocalizerSelector::Config selector;
    LocalizerConnections::Config connections;
    LocalizerStream::Config stream;
    StatusTimer::Config status;
  };
  struct Statistics {
    std::uint64_t submaps_sent = 0;
    std::uint64_t submaps_without_localizer = 0;
    std::uint64_t answers_received = 0;            ///< without repetitions
    std::uint64_t sessions_requested = 0;          ///< answers that asked for the session
    std::uint64_t localizers_chosen = 0;           ///< restarts of the same one included
    std::uint64_t successors = 0;                  ///< localizers that were to take over
    std::map<std::string, std::uint64_t> refused;  ///< messages that were not used, by reason
    std::optional<Duration> round_trip;
    double loss = 0.0;  ///< share of samples that do not arrive
    std::string localizer;
  };

  CloudClient(RobotId robot, Channel& channel, const Config& config);

  /// The next RobotStatus reports the quality.
  void update(Timestamp /*now*/, Quality quality) override { quality_ = quality; }
  void start_session(const RobotSession& session, Timestamp clock) override;
  void restart_session(const RobotSession& session, Timestamp clock) override;
  void submit(Submap submap, Timestamp clock) override;
  [[nodiscard]] std::vector<LocalizationResult> take_answers(Timestamp clock) override;
  [[nodiscard]] std::optional<Correction> take_correction() override {
    return answers_.take_correction();
  }
  void note_applied() override;
  void update_start(const MapOdomEstimate& start) override;

  [[nodiscard]] Statistics statistics() const;
  [[nodiscard]] LinkTraffic traffic() const override;
  /// Changes of the localizer and id conflicts since the last call, each a line for a log.
  std::vector<std::string> take_events() { return events_.take(); }

 private:
  void begin_session(Timestamp now);
  void receive_status(const Message& message, Timestamp now);
  std::optional<LocalizationResult> receive_answer(const Message& message, Timestamp now);
  [[nodiscard]] expected<void, MessageRefusal> check(const LocalizationResult& answer) const;
  void check_for_duplicate_id(const LocalizationResult& answer, Timestamp now);
  void session_requested(const LocalizationResult& answer, Timestamp now);
  bool take_over(const LocalizationResult& answer, Timestamp now);
  void update_localizer(Timestamp now);
  void choose(Timestamp now);
  void use_chosen(Timestamp now);
  void begin_successor(Timestamp now);
  void keep_connections(Timestamp now);
  void send_submaps(Timestamp now);
  void send_status(Timestamp now);
  template <typename Reason>
  void refuse(Reason reason) {
    ++statistics_.refused[std::string(name(reason))];
  }
  [[nodiscard]] const SubmapSender& sender() const { return streams_.current().uplink().sender(); }

  /// Of the timers; to be called with every time that is passed in.
  Timestamp time_at(Timestamp clock);
  [[nodiscard]] LocalizerStream::Time stream_time(Timestamp now) const { return {now, clock_}; }

  RobotId robot_;
  Channel& channel_;
  Timestamp clock_{};  // as it was passed in last
  SteadyTime steady_;
  SenderBinding writers_;
  LocalizerSelector selector_;
  LocalizerConnections connections_;
  SessionStreams streams_;
  AnswerHistory answers_;
  LocalizerEvents events_;
  Quality quality_ = Quality::kInitializing;
  Quality sent_quality_ = Quality::kInitializing;
  std::uint64_t answers_applied_ = 0;
  StatusTimer status_timer_;
  Statistics statistics_;
};

CloudClient::Config read_cloud_client_config(ConfigReader config);

}  // namespace fleetloc
