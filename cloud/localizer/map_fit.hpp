#pragma once

#include "cloud/localizer/degeneracy.hpp"
#include "cloud/localizer/landmark_placement.hpp"
#include "cloud/localizer/map_association.hpp"
#include "cloud/localizer/window_problem.hpp"
#include "shared/geometry/pose.hpp"

namespace fleetloc {

/// What the rounds of association and optimization have made of a window.
struct MapFit {
  Association association;   ///< of the last round
  MapConstraint constraint;  ///< by the matches that were optimized last
  bool is_solved = false;    ///< the last round was optimized, and the solver can use its result
  int rounds = 0;            ///< that were optimized
  int iterations = 0;        ///< of the solver, in all rounds
  double cost = 0.0;         ///< E_loc at the end
  Pose T_map_body;           ///< of the newest keyframe
  double median_residual = 0.0;    ///< of the matches, in standard deviations
  double innovation_sigmas = 0.0;  ///< see Acceptance::innovation_sigmas()

  void add(const WindowProblem::Solved& solved);  ///< of one more round
};

/// Median over the matches of the distance from the map (eq. 13 and 14), in the standard deviations
/// of one coordinate that the association states for a match outside of crowded cells. Zero
/// without matches.
double median_residual(const std::vector<MapMatch>& matches,
                       const LandmarkPositions& positions,
                       const AssociationConfig& config);

}  // namespace fleetloc
