#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "shared/trajectory/trajectory.hpp"

namespace fleetloc {

/// Of numbers that are not negative; zero without any.
struct Statistics {
  double median = 0.0;  ///< the mean of the two in the middle if their number is even
  double mean = 0.0;
  double rmse = 0.0;
  double std = 0.0;  ///< of the population, about the mean
  double max = 0.0;
};

Statistics statistics(std::vector<double> values);

/// Absolute trajectory error (Sturm et al. 2012), and that of the rotation.
struct TrajectoryError {
  std::size_t poses = 0;
  Statistics translation_m;
  Statistics rotation_deg;
};

TrajectoryError absolute_trajectory_error(std::span<const PosePair> pairs,
                                          const Pose& T_truth_estimate);

/// Relative error over a time (Sturm et al. 2012): error of the motion from each pose to the one
/// `interval` later, or the nearest to that within `tolerance`. Independent of the estimate's
/// frame. `poses` counts the pairs of instants.
TrajectoryError relative_trajectory_error(std::span<const PosePair> pairs,
                                          Duration interval,
                                          Duration tolerance);

/// Normalized estimation error squared per degree of freedom: near one if `covariance` (right
/// perturbation of the estimate) is consistent, above if it is overconfident. Nothing if the
/// covariance is not positive definite.
std::optional<double> nees_per_degree_of_freedom(const Pose& T_ref_truth,
                                                 const Pose& T_ref_estimate,
                                                 const Matrix6d& covariance);

}  // namespace fleetloc
