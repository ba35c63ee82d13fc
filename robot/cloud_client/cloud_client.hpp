#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robot/cloud_client/localizer_selector.hpp"
#include "shared/link/channel.hpp"
#include "shared/model/map_localizer.hpp"
#include "shared/model/pose_estimate.hpp"
#include "shared/protocol/submap_sender.hpp"

namespace fleetloc {

class ConfigReader;

/// The robot's end of the protocol: finds a localizer, tells it of the session, sends submaps and
/// gives each answer once. When the localizer falls silent, restarts or loses the session, the
/// session is announced again, with the start pose as it is known by then. Without a localizer
/// submaps are dropped and counted, never queued: an old submap is worth less than the next one.
///
/// From the first applied answer on the robot keeps to that answer's map.
class CloudClient final : public MapLocalizer {
 public:
  struct Config {
    LocalizerSelector::Config selector;
    double announcement_interval_s;  ///< until it is answered; doubles each time
    double max_announcement_interval_s;
    double min_announcement_interval_s;  ///< however often the localizer asks for it
    double status_interval_s;            ///< of what the robot says of itself
  };
  struct Statistics {
    std::uint64_t submaps_sent = 0;
    std::uint64_t submaps_without_localizer = 0;
    std::uint64_t answers_received = 0;            ///< without repetitions
    std::uint64_t sessions_requested = 0;          ///< answers that asked for the session
    std::uint64_t localizers_chosen = 0;           ///< and the same ones after a restart
    std::map<std::string, std::uint64_t> refused;  ///< messages that were not used, by reason
    std::optional<Duration> round_trip;
    double loss = 0.0;  ///< share of samples that do not arrive
    std::string localizer;
  };

  /// What the robot's end of the network has moved so far.
  struct Traffic {
    std::uint64_t submaps_sent = 0;
    std::uint64_t uplink_bytes = 0;    ///< payload
    std::uint64_t downlink_bytes = 0;  ///< payload
    std::uint64_t uplink_wire_bytes = 0;
    std::uint64_t downlink_wire_bytes = 0;
    double loss = 0.0;  ///< see Statistics
    std::optional<Duration> round_trip;
  };

  CloudClient(RobotId robot, Channel& channel, const Config& config);

  void start_session(const RobotSession& session, Timestamp now) override;
  void submit(Submap submap, Timestamp now) override;
  [[nodiscard]] std::vector<LocalizationResult> take_answers(Timestamp now) override;
  [[nodiscard]] std::optional<Correction> take_correction() override {
    return std::exchange(correction_, std::nullopt);
  }
  void note_applied() override;
  void update_start(const MapOdomEstimate& start) override { newest_start_ = start; }

  /// What the robot tells its localizer of itself from now on.
  void set_quality(Quality quality) { quality_ = quality; }

  [[nodiscard]] Statistics statistics() const;
  /// What the network has moved so far.
  [[nodiscard]] Traffic traffic() const;
  /// What has happened to the service since the last call, each a line for a log.
  std::vector<std::string> take_events();

 private:
  void receive_status(const Bytes& payload, Timestamp now);
  void receive_correction(const Bytes& payload);
  std::optional<LocalizationResult> receive_answer(const Bytes& payload, Timestamp now);
  [[nodiscard]] std::optional<std::string_view> why_refused(const LocalizationResult& answer) const;
  void session_requested(const LocalizationResult& answer, Timestamp now);
  void follow_selector(Timestamp now);
  void note_trouble();
  void suspect_shared_id(const LocalizationResult& answer, Timestamp now);
  void begin_service(Timestamp now);
  void announce_as_it_is(Timestamp now);
  void announce(Timestamp now);
  void announce_again(Timestamp now);
  void send_status(Timestamp now);
  void refuse(std::string_view reason) { ++statistics_.refused[std::string(reason)]; }
  void note(std::string event);
  [[nodiscard]] LocalizerSelector::Link link() const;

  RobotId robot_;
  Channel& channel_;
  Config config_;
  LocalizerSelector selector_;
  std::string used_;                     // the localizer in whose partition the robot writes
  std::optional<RobotSession> session_;  // as it was announced
  std::optional<MapOdomEstimate> newest_start_;
  bool answered_ = false;  // by the chosen localizer, in this session
  std::optional<Timestamp> announced_;
  double announcement_interval_s_ = 0.0;
  std::optional<Timestamp> status_sent_;
  Quality quality_ = Quality::kInitializing;
  std::uint64_t answers_applied_ = 0;
  std::optional<MapHash> answered_map_;  // of the newest answer with a pose
  SubmapSender sender_;
  std::optional<LocalizationResult> newest_;    // of this session
  std::optional<Correction> correction_;        // not yet taken
  std::optional<KeyframeId> corrected_anchor_;  // of the newest correction of this session
  std::string other_map_;  // the localizer that was last reported to have another map
  std::string trouble_;    // that was last reported
  std::optional<Timestamp> session_started_;
  int foreign_answers_ = 0;  // late ones, of sessions that are not this robot's
  std::vector<std::string> events_;
  Statistics statistics_;
};

CloudClient::Config read_cloud_client_config(ConfigReader config);

}  // namespace fleetloc
