#pragma once

#include <map>

#include <Eigen/Core>

#include "cloud/localizer/session_database.hpp"
#include "shared/model/camera.hpp"

namespace fleetloc {

using LandmarkPositions = std::map<LandmarkId, Eigen::Vector3d>;  ///< p_map [m]

/// Initial position of each landmark that the keyframes of `poses` (T_map_body) observe: the
/// cloud's solution, else the robot's estimate, else the least squares of what these keyframes
/// observe of it. Landmarks without any of these, or without a disparity, are left out.
LandmarkPositions placed_landmarks(const SessionDatabase& database,
                                   const std::map<KeyframeId, Pose>& poses,
                                   const RectifiedStereo& stereo);

/// Information of a landmark's position from one observation, given the pose [1/m^2].
Eigen::Matrix3d position_information(const StereoObservation& observation,
                                     const RectifiedStereo& stereo,
                                     const Pose& T_cam0_map,
                                     const Eigen::Vector3d& p_map,
                                     double pixel_sigma_px);

}  // namespace fleetloc
