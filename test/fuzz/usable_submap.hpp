#pragma once

#include "shared/model/camera.hpp"
#include "shared/model/submap.hpp"
#include "test/fuzz/target.hpp"

namespace fleetloc {

/// What estimators rely on: finite, ordered and in range.
inline void expect_usable(const Submap& submap) {
  require(!submap.keyframes.empty(), "a submap has keyframes");
  const SubmapKeyframe* before = nullptr;
  for (const SubmapKeyframe& keyframe : submap.keyframes) {
    require(!before || (before->id < keyframe.id && before->stamp < keyframe.stamp), "order");
    require(keyframe.T_odom_body.p.allFinite(), "a position is finite");
    require(std::abs(keyframe.T_odom_body.R.norm() - 1.0) < 1e-6, "a rotation is one");
    require(keyframe.tilt_sigma > 0.0, "a sigma is positive");
    for (const StereoObservation& one : keyframe.observations) {
      require(one.left.minCoeff() >= 0.0 && one.left.maxCoeff() < kRectifiedSize, "pixels");
      require(one.disparity >= 0.0, "a disparity is not negative");
    }
    before = &keyframe;
  }
  for (const VirtualEdge& edge : submap.edges) {
    require(edge.from < edge.to, "an edge leads forwards");
    require(edge.T_from_to.p.allFinite() && edge.information.allFinite(), "an edge is finite");
  }
}

}  // namespace fleetloc
