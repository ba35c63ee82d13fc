#pragma once

#include <string_view>

#include "shared/model/localization_result.hpp"

namespace fleetloc {

/// Why a window is not localized, in the order in which it is asked.
enum class Rejection {
  kSearching,        ///< the session has no start pose, and was not found in the map yet
  kAmbiguous,        ///< the same, and it may be at several places
  kTooFewKeyframes,  ///< connected to the newest one
  kNotCovered,       ///< too few landmarks have map around them
  kTooFewMatches,
  kDisagreement,        ///< too few of the landmarks off the ground are matched
  kRecentDisagreement,  ///< too few of those that only the newest keyframes have seen
  kNotSolved,           ///< the optimization failed
  kNotSettled,          ///< a first place that moves on with every round
  kPoorFit,             ///< the matches are too far from the map
  kBelowGround,         ///< too many landmarks would lie below the ground
  kInnovation,          ///< too far from where the odometry says that the robot is
  kSingular,            ///< there is no covariance
  kWeak,                ///< too uncertain along what the map does not constrain
  kUnconfirmed,         ///< a first place that is not certain enough; the robot must drive on
};

/// Name in diagnostics, e.g. "below_ground".
std::string_view name(Rejection rejection);

/// What it says of the place.
enum class PlaceEvidence { kNone, kFor, kAgainst };
PlaceEvidence evidence_of(Rejection rejection);

/// What the robot is told: the wire has fewer words.
LocalizationStatus status_of(Rejection rejection);

}  // namespace fleetloc
