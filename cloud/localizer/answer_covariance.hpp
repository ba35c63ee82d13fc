#pragma once

#include <optional>

#include "cloud/localizer/dead_reckoning.hpp"
#include "cloud/localizer/degeneracy.hpp"
#include "cloud/localizer/window_problem.hpp"

namespace fleetloc {

/// How uncertain the pose of the window's newest keyframe is.
struct AnswerCovariance {
  Matrix6d covariance = Matrix6d::Zero();  ///< right perturbation of T_map_body
  double weak_sigma_m = 0.0;               ///< the largest along a weak direction
};

/// The marginal of `system`. Along directions that the map does not constrain it is raised to the
/// covariance of `prior`, carried to the newest keyframe by the odometry of `problem`: what the
/// optimization adds to the prior there is not the map's.
/// @param rivals  of the keyframe of `prior`: RigidAlignment::Result::rivals
/// @return nothing if a system is singular
std::optional<AnswerCovariance> answer_covariance(const WindowProblem& problem,
                                                  const WindowSystem& system,
                                                  const MapConstraint& constraint,
                                                  const PosePrior& prior,
                                                  const Matrix6d& rivals);

}  // namespace fleetloc
