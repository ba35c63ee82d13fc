#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "shared/core/ids.hpp"
#include "shared/core/time.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/model/observation.hpp"

namespace fleetloc {

/// pi: the tilt_sigma of a keyframe whose tilt is not measured.
inline constexpr double kUnknownTiltRad = 3.14159;

/// Which landmarks the observations of a keyframe are of: all, or every second one.
struct ObservationSubset {
  std::uint32_t stride = 1;  ///< 1 or 2
  std::uint32_t offset = 0;  ///< below stride

  [[nodiscard]] bool has(LandmarkId landmark, KeyframeId keyframe) const {
    return (static_cast<std::uint32_t>(landmark) + static_cast<std::uint32_t>(keyframe)) % stride ==
           offset;
  }
};

/// A keyframe for the cloud: observations, and initial values.
struct SubmapKeyframe {
  KeyframeId id{};
  Revision revision{};  ///< of this item; the newest wins
  Timestamp stamp;
  Pose T_odom_body;            ///< an estimate, never a measurement
  double tilt_sigma{};         ///< of its roll and pitch, without what came from the cloud [rad]
  bool is_reference = false;   ///< only edges need it: its observations are not in this submap
  double pixel_step_px = 0.0;  ///< the observations are rounded to multiples of it; 0: exact
  ObservationSubset subset{};  ///< of other landmarks nothing is said
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
  bool is_final = false;  ///< the robot will not estimate it again
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

/// What a submap tells of itself: whose it is, and which.
struct SubmapHeader {
  RobotId robot;
  SessionNumber session{};
  Incarnation incarnation{};  ///< of the receiving localizer
  SampleNumber number{};
  KeyframeId keyframe{};  ///< the newest one
  Revision revision{};    ///< of that keyframe
  Timestamp stamp;        ///< of that keyframe
};

/// Expects at least one keyframe.
inline SubmapHeader header_of(const Submap& submap) {
  const SubmapKeyframe& newest = submap.keyframes.back();
  return {.robot = submap.robot,
          .session = submap.session,
          .incarnation = submap.incarnation,
          .number = submap.number,
          .keyframe = newest.id,
          .revision = newest.revision,
          .stamp = newest.stamp};
}

}  // namespace fleetloc
