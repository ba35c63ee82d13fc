#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>

#include "shared/geometry/pose.hpp"

namespace fleetloc {

/// A calibrated camera: pinhole with one of two distortion models.
struct Camera {
  enum class Distortion {
    kRadialTangential,  ///< k1, k2, p1, p2
    kEquidistant,       ///< k1, k2, k3, k4 (Kannala and Brandt)
  };
  int width_px = 0;
  int height_px = 0;
  Eigen::Vector2d focal_px = Eigen::Vector2d::Zero();
  Eigen::Vector2d center_px = Eigen::Vector2d::Zero();
  Distortion distortion = Distortion::kRadialTangential;
  Eigen::Vector4d coefficients = Eigen::Vector4d::Zero();
};

/// Pixel of a point in the camera's frame (z forward); nothing for a point that is not in front.
/// The pixel may lie outside of the image.
std::optional<Eigen::Vector2d> project(const Camera& camera, const Eigen::Vector3d& p_cam);

/// Direction with z = 1 that `pixel` looks along; nothing where the distortion cannot be inverted.
std::optional<Eigen::Vector3d> unproject(const Camera& camera, const Eigen::Vector2d& pixel);

/// Two cameras on the body (the IMU frame).
struct StereoCalibration {
  Camera cam0;
  Camera cam1;
  Pose T_body_cam0;
  Pose T_body_cam1;
};

/// The ideal stereo pair in which all observations are stated: no distortion, parallel optical
/// axes, one focal length, the baseline along x. `cam0` below is its left camera.
struct RectifiedStereo {
  double focal_px = 0.0;
  Eigen::Vector2d center_px = Eigen::Vector2d::Zero();
  double baseline_m = 0.0;
  Pose T_body_cam0;
};

/// The pair stays within [0, kRectifiedSize) px, whatever the cameras: the codec relies on it.
inline constexpr double kRectifiedSize = 2048.0;

/// Both cameras rotated about their own centers. The focal length is that of cam0, less where
/// the images would otherwise not fit into kRectifiedSize; the principal point is its middle.
RectifiedStereo rectified(const StereoCalibration& calibration);

/// (u_left, v, u_right) [px] of a point in the left camera's frame with z > 0.
Eigen::Vector3d project(const RectifiedStereo& stereo, const Eigen::Vector3d& p_cam0);

}  // namespace fleetloc
