#pragma once

#include <map>
#include <utility>
#include <vector>

#include "shared/core/ids.hpp"
#include "shared/model/correction.hpp"

namespace fleetloc {

struct WindowGraph;
struct GraphFactor;

/// The cloud's constraints on the states of a window: one e_pp per landmark and one e_rt per pair
/// of keyframes, from the newest answer that contains them; pairs do not overlap. They enter the
/// optimization only: covariance, prior and submap are from the robot's own measurements, or the
/// cloud would count its map twice.
struct WindowCorrections {
  struct Landmark {
    KeyframeId anchor{};
    Correction::Landmark correction;
  };
  using Pair = std::pair<KeyframeId, KeyframeId>;  // from, to

  KeyframeId newest_anchor{};
  std::map<LandmarkId, Landmark> landmarks;
  std::map<Pair, Correction::RelativePose> relative_poses;
};

struct MergeCount {
  int applied = 0;  ///< constraints that are in the window now
  int ignored = 0;  ///< constraints on other states, or of an outdated answer
};

/// Number of its constraints.
int size_of(const Correction& correction);

/// Adds the constraints on keyframes and active landmarks of the window. The correction must be
/// finite and its informations positive semi-definite.
MergeCount merge(const Correction& correction, WindowGraph& graph);

/// Drops all constraints, but not what tells which answers are outdated.
void forget_corrections(WindowGraph& graph);

/// Drops constraints on keyframes and landmarks that have left the window.
void drop_stale_corrections(WindowGraph& graph);

/// e_pp and e_rt; the number of residuals (three or six) tells them apart.
std::vector<GraphFactor> correction_factors(WindowGraph& graph);

}  // namespace fleetloc
