#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "shared/core/ids.hpp"
#include "shared/core/time.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/model/observation.hpp"

namespace fleetloc {

/// A keyframe for the cloud: observations, and initial values.
struct SubmapKeyframe {
  KeyframeId id{};
  Revision revision{};  ///< of this item; the newest wins
  Timestamp stamp;
  Pose T_odom_body;     ///< an estimate, never a measurement
  double tilt_sigma{};  ///< of its roll and pitch, without what came from the cloud [rad]
  std::vector<StereoObservation> observations;  ///< strictly increasing by landmark
};

/// Virtual odometry between two consecutive keyframes (paper, eq. 5 to 8): a relative pose with
/// the information that remains of the IMU once velocities and biases are marginalized out.
/// The error is Log(T_from_to^-1 * T_odom_from^-1 * T_odom_to), [rotation rad, translation m].
struct VirtualEdge {
  KeyframeId from{};
  KeyframeId to{};
  Revision revision{};  ///< of this item; the newest wins
  Pose T_from_to;
  Matrix6d information = Matrix6d::Identity();
};

/// The robot's estimate of a landmark: an initial value, never a measurement.
struct SubmapLandmark {
  LandmarkId id{};
  Eigen::Vector3d p_odom = Eigen::Vector3d::Zero();  ///< [m]
};

/// What a robot sends to the cloud: the paper's "virtual observation".
struct Submap {
  RobotId robot;
  SessionNumber session{};
  Incarnation incarnation{};              ///< of the receiving localizer
  SampleNumber number{};                  ///< +1 per sample sent
  std::vector<SubmapKeyframe> keyframes;  ///< oldest first, strictly increasing by id; not empty
  std::vector<VirtualEdge> edges;         ///< strictly increasing by `to`
  std::vector<SubmapLandmark> landmarks;  ///< strictly increasing by id
};

}  // namespace fleetloc
