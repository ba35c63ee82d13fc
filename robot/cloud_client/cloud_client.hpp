#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "shared/link/channel.hpp"
#include "shared/model/map_localizer.hpp"
#include "shared/protocol/repetition.hpp"
#include "shared/protocol/submap_sender.hpp"
#include "shared/run_folder/run_folder.hpp"

namespace fleetloc {

class ConfigReader;

/// The robot's end of the protocol: finds a localizer, tells it of the session, sends submaps and
/// gives each answer once. Without a localizer submaps are dropped and counted, never queued: an
/// old submap is worth less than the next one.
class CloudClient final : public MapLocalizer {
 public:
  struct Config {
    Repetition::Config session_repetition;  ///< of the session's announcement, until it is answered
  };
  struct Statistics {
    std::uint64_t submaps_sent = 0;
    std::uint64_t submaps_without_localizer = 0;
    std::uint64_t answers_received = 0;            ///< without repetitions
    std::map<std::string, std::uint64_t> refused;  ///< messages that were not used, by reason
    std::optional<Duration> round_trip;
    double loss = 0.0;  ///< share of samples that do not arrive
    std::string localizer;
  };

  CloudClient(RobotId robot, Channel& channel, const Config& config);

  void start_session(const RobotSession& session, Timestamp now) override;
  void submit(Submap submap, Timestamp now) override;
  [[nodiscard]] std::vector<Answer> take_answers(Timestamp now) override;
  [[nodiscard]] std::optional<Correction> take_correction() override {
    return std::exchange(correction_, std::nullopt);
  }
  void update_start(const StartPose& start) override {
    if (session_) session_->start = start;
  }

  [[nodiscard]] Statistics statistics() const;
  /// What the network has moved so far.
  [[nodiscard]] RunTraffic traffic() const;

 private:
  void receive_status(const Bytes& payload);
  std::optional<Answer> receive_answer(const Bytes& payload, Timestamp now);
  void receive_correction(const Bytes& payload);
  void choose_localizer(Timestamp now);
  void announce(Timestamp now);
  void refuse(std::string_view reason) { ++statistics_.refused[std::string(reason)]; }

  RobotId robot_;
  Channel& channel_;
  std::map<std::string, LocalizerStatus> localizers_;  // the latest of each
  std::string localizer_;                              // the chosen one; empty: none yet
  std::optional<RobotSession> session_;
  Repetition announcement_;
  bool answered_ = false;  // by the chosen localizer, in this session
  SubmapSender sender_;
  std::optional<Answer> newest_;                // of this session
  std::optional<Correction> correction_;        // not yet taken
  std::optional<KeyframeId> corrected_anchor_;  // of the newest correction of this session
  Statistics statistics_;
};

CloudClient::Config read_cloud_client_config(ConfigReader config);

}  // namespace fleetloc
