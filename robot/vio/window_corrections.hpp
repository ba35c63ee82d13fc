#pragma once

#include <map>
#include <utility>
#include <vector>

#include "shared/core/ids.hpp"
#include "shared/model/correction.hpp"

namespace fleetloc {

struct WindowGraph;
struct GraphFactor;

/// What the cloud has said of the states of a window: one constraint for each landmark and for
/// each pair of keyframes, from the newest answer that knew them. They take part in the
/// optimization and in nothing else: the covariance, the prior and the submap hold what the robot
/// has measured itself, for the cloud would otherwise be told its own map as news.
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
  int ignored = 0;  ///< constraints between states that are not, or of an answer overtaken before
};

/// Number of its constraints.
int size_of(const Correction& correction);

/// Takes over what concerns keyframes of the window, and landmarks that take part in it. The
/// correction must be finite and its informations positive semi-definite.
MergeCount merge(const Correction& correction, WindowGraph& graph);

/// Drops what concerns keyframes and landmarks that have left the window.
void forget_departed_corrections(WindowGraph& graph);

/// e_pp and e_rt; the number of residuals (three or six) tells them apart.
std::vector<GraphFactor> correction_factors(WindowGraph& graph);

}  // namespace fleetloc
