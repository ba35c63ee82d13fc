#pragma once

#include <map>

#include <Eigen/Core>

#include "cloud/localizer/session_database.hpp"
#include "shared/model/camera.hpp"

namespace fleetloc {

using LandmarkPositions = std::map<LandmarkId, Eigen::Vector3d>;  ///< p_map [m]

/// Where to start with each landmark that the keyframes of `poses` (T_map_body) saw: at the cloud's
/// solution, else at the robot's estimate, else where the stereo pair saw it nearest. Landmarks
/// that only one camera saw and of which the robot says nothing have no position.
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
