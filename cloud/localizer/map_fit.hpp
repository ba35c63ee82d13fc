#pragma once

#include "cloud/localizer/degeneracy.hpp"
#include "cloud/localizer/landmark_placement.hpp"
#include "cloud/localizer/map_association.hpp"
#include "cloud/localizer/window_problem.hpp"
#include "shared/geometry/pose.hpp"

namespace fleetloc {

/// What the rounds of association and optimization have made of a window.
struct MapFit {
  Association association;         ///< of the last round
  Association recent;              ///< at the end, of what only the newest keyframes have seen
  MapConstraint constraint;        ///< by the matches that were optimized last
  bool is_solved = false;          ///< the solver could use the result of the last optimization
  int rounds = 0;                  ///< that came to an optimization
  int iterations = 0;              ///< of the solver, in all rounds
  double cost = 0.0;               ///< E_loc at the end
  double moved_m = 0.0;            ///< the newest keyframe in the last round [m, rad]
  Pose T_map_body;                 ///< of the newest keyframe
  double median_residual = 0.0;    ///< of the matches, in standard deviations
  double innovation_sigmas = 0.0;  ///< see Acceptance::innovation_sigmas()

  /// One more round.
  void add(const WindowProblem::Solved& solved);
};

/// Median over the matches of their distance from the map (paper, eq. 13 and 14), in standard
/// deviations: those of the association, without the share in a crowded cell. Zero without matches.
/// @param positions  of all landmarks that are matched, after the optimization
double median_residual(const std::vector<MapMatch>& matches,
                       const LandmarkPositions& positions,
                       const AssociationConfig& config);

}  // namespace fleetloc
