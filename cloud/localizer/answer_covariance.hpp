#pragma once

#include <optional>

#include "cloud/localizer/degeneracy.hpp"
#include "cloud/localizer/prediction.hpp"
#include "cloud/localizer/window_problem.hpp"

namespace fleetloc {

/// How uncertain the pose of the window's newest keyframe is.
struct AnswerCovariance {
  Matrix6d covariance = Matrix6d::Zero();  ///< right perturbation of T_map_body
  double weak_sigma_m = 0.0;               ///< the largest along a weak direction
};

/// The marginal of `system`. Along directions that the map does not constrain it is raised to what
/// was known before the window, carried to the newest keyframe by the odometry of `problem`: what
/// the optimization adds to it there is noise of the map's normals. A first place was looked for in
/// all the room that the start pose leaves, and its matches were chosen with it: there more
/// directions count. A place that was found by a search comes with no start pose to fall back to.
/// @param other_places  of the newest keyframe: second moment of those that fit nearly as well
/// @return nothing if a system is singular
std::optional<AnswerCovariance> answer_covariance(const WindowProblem& problem,
                                                  const WindowSystem& system,
                                                  const MapConstraint& constraint,
                                                  const DegeneracyConfig& config,
                                                  const Prediction& prediction,
                                                  const Matrix6d& other_places);

}  // namespace fleetloc
