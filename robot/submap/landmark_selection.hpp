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

/// Which landmarks a submap holds.
struct LandmarkSelection {
  int more_observations_than;       ///< the paper's theta
  double max_relative_depth_sigma;  ///< sigma of depth / depth
  int max_per_keyframe;
  double cell_px;  ///< side of the cells over which those of one image are spread
};

/// The landmarks to send: those of `kept`, and reliable ones, at most so many in each image, spread
/// over it, those that are seen most often first. Newer images are served first.
/// @param images     observations of the keyframes, oldest first
/// @param landmarks  strictly increasing by id
/// @param kept       were sent before: they take up room, and stay even where there is none
std::set<LandmarkId> select_landmarks(const LandmarkSelection& selection,
                                      std::span<const std::vector<StereoObservation>* const> images,
                                      std::span<const CandidateLandmark> landmarks,
                                      const std::set<LandmarkId>& kept);

/// How many of them are reliable, whether there is room for them or not.
int reliable_landmarks(const LandmarkSelection& selection,
                       std::span<const CandidateLandmark> landmarks);

}  // namespace fleetloc
