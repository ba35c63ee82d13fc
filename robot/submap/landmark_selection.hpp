#pragma once

#include <set>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "shared/core/ids.hpp"
#include "shared/model/observation.hpp"

namespace fleetloc {

/// A landmark of the odometry's window.
struct CandidateLandmark {
  LandmarkId id{};
  Eigen::Vector3d p_odom = Eigen::Vector3d::Zero();  ///< [m]
  int observations = 0;                              ///< keyframes that see it
  double relative_depth_sigma = 0.0;                 ///< sigma of depth / depth
};

/// Criteria for the landmarks of a submap.
struct LandmarkSelection {
  int more_observations_than;       ///< the paper's theta
  double max_relative_depth_sigma;  ///< sigma of depth / depth
  int max_per_keyframe;
  double cell_px;  ///< side of the cells over which those of one image are spread
};

/// The landmarks to send: those of `already_sent`, and reliable ones up to max_per_keyframe in each
/// image, spread over its cells, most observations first. Newest image first.
/// @param images     observations of the keyframes, oldest first
/// @param landmarks  strictly increasing by id
/// @param already_sent  always selected, and counted in max_per_keyframe
std::set<LandmarkId> select_landmarks(const LandmarkSelection& selection,
                                      std::span<const std::vector<StereoObservation>* const> images,
                                      std::span<const CandidateLandmark> landmarks,
                                      const std::set<LandmarkId>& already_sent);

/// Number of landmarks that meet the two thresholds, selected or not.
int reliable_landmarks(const LandmarkSelection& selection,
                       std::span<const CandidateLandmark> landmarks);

}  // namespace fleetloc
