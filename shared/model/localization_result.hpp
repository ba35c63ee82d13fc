#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "shared/core/ids.hpp"
#include "shared/core/time.hpp"
#include "shared/geometry/pose.hpp"

namespace fleetloc {

/// The result of one localization; all but kLocalized and kNeedFull name a rejection.
enum class LocalizationStatus {
  kLocalized,
  kNeedFull,         ///< the localizer has lost the earlier submaps
  kSearching,        ///< the session has no start pose, and was not found in the map yet
  kTooFewKeyframes,  ///< connected to the newest one
  kNoMapCoverage,    ///< too few landmarks have map surface near them
  kTooFewMatches,    ///< too few matches survive the gate
  kNotConverged,     ///< the optimization failed or moved further than the prior allows
  kPoorFit,          ///< the residuals of the matches are too large
  kDegenerate,       ///< the map does not constrain the pose well enough to be sent
  kUnconfirmed,      ///< the first pose is not confirmed yet; the robot must drive on
  kLost,       ///< the session's place does not explain what is seen: another one is looked for
  kAmbiguous,  ///< as kSearching, and what is seen fits several places alike: it must drive on
};

/// Name in logs and summaries, e.g. "too_few_matches".
std::string_view name(LocalizationStatus status);

/// Which samples the cloud has stored: every number below base, and base + i for every bit i.
struct Acknowledgements {
  SampleNumber base{};
  std::uint64_t bitmap = 0;
};

/// The cloud's answer to the submaps so far. Idempotent: a newer one supersedes it.
struct LocalizationResult {
  RobotId robot;
  SessionNumber session{};
  std::string localizer;
  Incarnation incarnation{};
  std::uint32_t number = 0;  ///< from 1, +1 per sample to this robot: tells which ones were lost
  Acknowledgements acknowledgements;
  LocalizationStatus status{};
  KeyframeId keyframe{};
  Revision revision{};  ///< of the keyframe that was localized
  Timestamp stamp;      ///< of the keyframe, the newest of the window behind the answer
  /// At which the robot may be, while it is searched for, as far as the latest search has come;
  /// 0..255, 0 if there was none, or it has found none.
  int places = 0;
  Timestamp oldest_stamp;  ///< of the oldest keyframe of that window; only if kLocalized
  MapHash map_hash{};
  Pose T_map_body;                         ///< at stamp; only if kLocalized, like what follows
  Matrix6d covariance = Matrix6d::Zero();  ///< right perturbation of T_map_body
  Duration holding_time{};                 ///< since the newest acknowledged sample arrived
};

}  // namespace fleetloc
