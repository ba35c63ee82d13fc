#pragma once

#include <optional>
#include <vector>

#include "shared/core/time.hpp"
#include "shared/model/correction.hpp"
#include "shared/model/localization_result.hpp"
#include "shared/model/session.hpp"
#include "shared/model/submap.hpp"

namespace fleetloc {

/// Localizes submaps in the laser map. The robot's only interface to the cloud: in production a
/// client on the network, in tests the cloud's localizer in the same process. Answers come late,
/// out of order or never. Time is passed in, so that every run can be replayed.
class MapLocalizer {
 public:
  MapLocalizer() = default;
  virtual ~MapLocalizer() = default;
  MapLocalizer(const MapLocalizer&) = delete;
  MapLocalizer& operator=(const MapLocalizer&) = delete;

  /// Ends the session before it; submaps of a session are accepted only after this.
  virtual void start_session(const RobotSession& session, Timestamp now) = 0;

  virtual void submit(Submap submap, Timestamp now) = 0;

  /// What has arrived until `now`, oldest first; each answer is returned once.
  [[nodiscard]] virtual std::vector<LocalizationResult> take_answers(Timestamp now) = 0;

  /// The newest correction of the session that had arrived when answers were last taken, once.
  [[nodiscard]] virtual std::optional<Correction> take_correction() = 0;

  /// An answer has been applied.
  virtual void note_applied() = 0;

  /// The newest T_map_odom, with which another localizer would start the session.
  virtual void update_start(const MapOdomEstimate& start) = 0;
};

}  // namespace fleetloc
