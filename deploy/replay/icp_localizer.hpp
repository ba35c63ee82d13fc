#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "cloud/laser_map/laser_map.hpp"
#include "deploy/replay/icp.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/model/map_localizer.hpp"

namespace fleetloc {

/// A baseline to compare the localizer with: each submap by itself, its landmarks aligned to the
/// map's points by ICP, from the last answer and the odometry since. No window, and a fixed
/// covariance. In simulated time and without a link; while it works, a newer submap replaces the
/// one that waits.
class IcpLocalizer final : public MapLocalizer {
 public:
  struct Config {
    IcpConfig icp;
    double min_matched_share;  ///< of the landmarks, by IcpConfig::max_distance_m
    double max_rms_m;          ///< of their distances to the map's points
    double sigma_m;            ///< of an answer
    double sigma_rad;
  };

  /// @param localization_time  assumed for each alignment
  IcpLocalizer(std::shared_ptr<const LaserMap> map,
               const Config& config,
               Duration localization_time);

  void update(Timestamp /*now*/, Quality /*quality*/) override {}
  void start_session(const RobotSession& session, Timestamp now) override;
  void submit(Submap submap, Timestamp now) override;
  [[nodiscard]] std::vector<LocalizationResult> take_answers(Timestamp now) override;
  [[nodiscard]] std::optional<Correction> take_correction() override { return std::nullopt; }
  void note_applied() override {}
  void update_start(const MapOdomEstimate&) override {}  // there is no other localizer to start
  [[nodiscard]] LinkTraffic traffic() const override { return {}; }

 private:
  struct Running {
    LocalizationResult answer;
    Timestamp ready;
  };
  void advance(Timestamp now);
  [[nodiscard]] LocalizationResult answer_to(const Submap& submap);
  [[nodiscard]] LocalizationStatus judge(const IcpResult& result) const;

  std::shared_ptr<const LaserMap> map_;
  IcpTarget target_;
  Config config_;
  Duration localization_time_;
  std::optional<RobotSession> session_;
  std::optional<Pose> T_map_odom_;
  std::optional<Submap> waiting_;
  std::optional<Running> running_;
  std::vector<LocalizationResult> answers_;
};

/// Strict; throws ConfigError.
IcpLocalizer::Config read_icp_localizer_config(ConfigReader section);

}  // namespace fleetloc
