#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "robot/cloud_client/localizer_connections.hpp"
#include "robot/cloud_client/localizer_selector.hpp"
#include "robot/cloud_client/localizer_stream.hpp"
#include "robot/cloud_client/message_refusal.hpp"
#include "shared/core/expected.hpp"
#include "shared/link/channel.hpp"
#include "shared/model/map_localizer.hpp"
#include "shared/model/pose_estimate.hpp"
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
  void submit(Submap submap, Timestamp clock) override;
  [[nodiscard]] std::vector<LocalizationResult> take_answers(Timestamp clock) override;
  [[nodiscard]] std::optional<Correction> take_correction() override {
    return std::exchange(correction_, std::nullopt);
  }
  void note_applied() override;
  void update_start(const MapOdomEstimate& start) override;

  [[nodiscard]] Statistics statistics() const;
  [[nodiscard]] LinkTraffic traffic() const override;
  /// Changes of the localizer and id conflicts since the last call, each a line for a log.
  std::vector<std::string> take_events();

 private:
  /// Answers with an equal one are repetitions.
  using AnswerIdentity =
      std::tuple<std::string, Incarnation, KeyframeId, Revision, LocalizationStatus>;

  static AnswerIdentity identity(const LocalizationResult& answer);
  void receive_status(const Bytes& payload, Timestamp now);
  void receive_correction(Correction correction);
  std::optional<LocalizationResult> receive_answer(const Bytes& payload, Timestamp now);
  [[nodiscard]] bool may_take_over(const LocalizationResult& answer, Timestamp now) const;
  [[nodiscard]] expected<void, MessageRefusal> check(const LocalizerStream& stream,
                                                     const LocalizationResult& answer) const;
  void session_requested(LocalizerStream& stream, const LocalizationResult& answer, Timestamp now);
  void update_localizer(Timestamp now);
  void report_other_map();
  void report_warning();
  void check_for_duplicate_id(const LocalizationResult& answer, Timestamp now);
  void choose(Timestamp now);
  void begin_with_chosen(Timestamp now);
  void begin_successor(Timestamp now);
  void drop_successor();
  void hand_over();
  void note_chosen();
  void keep_connections(Timestamp now);
  void send_submaps(Timestamp now);
  void send_status(Timestamp now);
  /// Counts a refusal, if it is one. @return the value, or that of nothing
  template <typename T>
  T taken(const expected<T, MessageRefusal>& result) {
    if (result) return *result;
    refuse(result.error());
    return T{};
  }
  void count(const expected<void, MessageRefusal>& result) {
    if (!result) refuse(result.error());
  }
  template <typename Reason>
  void refuse(Reason reason) {
    ++statistics_.refused[std::string(name(reason))];
  }
  void note(std::string event);
  [[nodiscard]] LocalizerSelector::Link link() const;

  /// Of the timers; to be called with every time that is passed in.
  Timestamp time_at(Timestamp clock);
  [[nodiscard]] LocalizerStream::Time stream_time(Timestamp now) const { return {now, clock_}; }

  RobotId robot_;
  Channel& channel_;
  Timestamp clock_{};  // as it was passed in last
  SteadyTime steady_;
  LocalizerSelector selector_;
  LocalizerConnections connections_;
  LocalizerStream stream_;                    // to the chosen one, if there is one
  std::optional<LocalizerStream> successor_;  // to the one that is to take over
  Quality quality_ = Quality::kInitializing;
  Quality sent_quality_ = Quality::kInitializing;
  std::uint64_t answers_applied_ = 0;
  std::optional<MapHash> answered_map_;  // of the newest answer with a pose
  StatusTimer status_timer_;
  std::deque<AnswerIdentity> given_;            // the latest answers of this session
  double window_s_ = 0.0;                       // that the latest of them rests on
  std::optional<Timestamp> localized_;          // arrival of the latest answer with a pose
  std::optional<Correction> correction_;        // not yet consumed
  std::optional<KeyframeId> corrected_anchor_;  // of the newest correction of this session
  std::string other_map_;  // the localizer that was last reported to have another map
  std::string reported_warning_;
  std::optional<Timestamp> session_started_;
  int foreign_answers_ = 0;  // late ones, of sessions that are not this robot's
  std::vector<std::string> events_;
  Statistics statistics_;
};

CloudClient::Config read_cloud_client_config(ConfigReader config);

}  // namespace fleetloc
