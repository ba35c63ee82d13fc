#pragma once

#include <cstddef>
#include <span>

#include "deploy/sim/motion/motion_extremes.hpp"
#include "deploy/sim/motion/spline_motion.hpp"
#include "shared/core/time.hpp"
#include "shared/trajectory/trajectory.hpp"

namespace fleetloc {

/// How recorded poses become a motion.
struct RecordFitConfig {
  double knot_interval_s = 0.1;
  /// Cutoff frequencies of the smoothing (half of the amplitude passes); where a limit is exceeded,
  /// they are lowered locally until it holds.
  double position_cutoff_hz = 1.0;
  double rotation_cutoff_hz = 1.0;
  MotionMagnitudes limits;
  double max_gap_s = 5.0;  ///< a longer one between two poses is an error
  int max_rounds = 200;    ///< of lowering
};

/// Distances between record and motion.
struct FitResidual {
  double median = 0.0;
  double p95 = 0.0;
  double max = 0.0;
};

struct RecordFit {
  SplineMotion motion;  ///< the ground truth of the simulation; its time zero is `start`
  Timestamp start;      ///< the record's earliest stamp
  FitResidual position_m;
  FitResidual rotation_deg;
  MotionMagnitudes greatest;
  std::size_t outliers = 0;  ///< poses that counted with less than a third of their weight
  std::size_t repeated_stamps = 0;
  bool within_limits = false;  ///< false: `max_rounds` were not enough
};

/// The smoothing spline of the poses that is within the limits. Robust: Huber weights by the median
/// residual. Poses in any order, stamps may repeat and jitter. Throws std::invalid_argument if
/// there are fewer than eight stamps or a gap between them is too long.
RecordFit fit_record(std::span<const StampedPose> poses, const RecordFitConfig& config);

}  // namespace fleetloc
