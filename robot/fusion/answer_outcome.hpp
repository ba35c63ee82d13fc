#pragma once

#include <string_view>

#include "shared/core/expected.hpp"

namespace fleetloc {

/// Why the fusion does not use a measurement. Odometry: kNotFinite, kOlderThanApplied or
/// kBeforeImu; answers of the cloud: any but the last.
enum class FusionRejection {
  kNotFinite,
  kBadCovariance,     ///< not symmetric, or not positive definite
  kNotLocalized,      ///< it has no pose
  kWrongSession,      ///< it belongs to another session of the odometry
  kWrongMap,          ///< it refers to another map than the first applied answer
  kTooOld,            ///< older than the buffer
  kUnknownStamp,      ///< no frame of the odometry has that stamp
  kDuplicate,         ///< its revision is stored already
  kOlderThanApplied,  ///< a newer one is
  kGated,             ///< by its chi-square
  kImplausibleTilt,   ///< it would initialize the filter with gravity too far from the map's -z
  kBeforeImu,         ///< the IMU's buffer begins after it
};

/// Name in files, e.g. "implausible_tilt".
std::string_view name(FusionRejection reason);

/// What an answer did that was used.
enum class AnswerEffect {
  kApplied,
  kRestarted,  ///< applied; its hypothesis replaced a contradicting estimate
};

using AnswerOutcome = expected<AnswerEffect, FusionRejection>;

/// Name in files of either.
std::string_view name(const AnswerOutcome& outcome);

}  // namespace fleetloc
