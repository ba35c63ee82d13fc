#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "shared/core/time.hpp"
#include "shared/model/correction.hpp"
#include "shared/model/localization_result.hpp"
#include "shared/model/pose_estimate.hpp"
#include "shared/model/session.hpp"
#include "shared/model/submap.hpp"

namespace fleetloc {

/// Traffic of the robot's end of the network since the program started.
struct LinkTraffic {
  std::uint64_t submaps_sent = 0;
  std::uint64_t uplink_bytes = 0;    ///< payload
  std::uint64_t downlink_bytes = 0;  ///< payload
  std::uint64_t uplink_wire_bytes = 0;
  std::uint64_t downlink_wire_bytes = 0;
  double loss = 0.0;  ///< share of samples that do not arrive
  std::optional<Duration> round_trip;
};

/// Localizes submaps in the laser map. The robot's only interface to the cloud: in production a
/// client on the network, in tests the cloud's localizer in the same process. Answers come late,
/// out of order or never. Time is passed in, so that every run can be replayed.
class MapLocalizer {
 public:
  MapLocalizer() = default;
  virtual ~MapLocalizer() = default;
  MapLocalizer(const MapLocalizer&) = delete;
  MapLocalizer& operator=(const MapLocalizer&) = delete;

  /// The robot's clock, and how good its pose is: to be called at IMU rate, before the others.
  virtual void update(Timestamp now, Quality quality) = 0;

  /// Ends the session before it; submaps of a session are accepted only after this.
  virtual void start_session(const RobotSession& session, Timestamp now) = 0;

  /// The same, where the robot's odometry goes on: what was submitted so far is of the new session,
  /// too.
  virtual void restart_session(const RobotSession& session, Timestamp now) {
    start_session(session, now);
  }

  virtual void submit(Submap submap, Timestamp now) = 0;

  /// What has arrived until `now`, oldest first; each answer is returned once.
  [[nodiscard]] virtual std::vector<LocalizationResult> take_answers(Timestamp now) = 0;

  /// The newest correction of the session that had arrived when answers were last taken, once.
  [[nodiscard]] virtual std::optional<Correction> take_correction() = 0;

  /// An answer has been applied.
  virtual void note_applied() = 0;

  /// The newest T_map_odom, with which another localizer would start the session.
  virtual void update_start(const MapOdomEstimate& start) = 0;

  [[nodiscard]] virtual LinkTraffic traffic() const = 0;
};

}  // namespace fleetloc
