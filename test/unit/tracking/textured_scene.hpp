#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "shared/geometry/pose.hpp"
#include "shared/model/camera.hpp"
#include "shared/model/stereo_frame.hpp"

namespace fleetloc {

/// A textured wall, and a poster in front of it that may move, in a stereo camera with distortion.
/// World: the wall is the plane z = kWall, the camera looks along z when its pose is the identity.
class TexturedScene {
 public:
  static constexpr double kWall_m = 3.0;
  static constexpr double kPoster_m = 2.0;
  static constexpr double kPosterHalf_m = 0.35;  // it is a square

  TexturedScene();

  [[nodiscard]] const StereoCalibration& calibration() const { return calibration_; }
  [[nodiscard]] const RectifiedStereo& stereo() const { return stereo_; }

  /// @param poster  its center in x and y [m]; none: there is no poster
  [[nodiscard]] StereoFrame render(
      const Pose& T_world_body, const std::optional<Eigen::Vector2d>& poster = std::nullopt) const;

  /// The point of the wall at a pixel of the rectified left image.
  [[nodiscard]] Eigen::Vector3d wall_point(const Pose& T_world_body,
                                           const Eigen::Vector2d& rectified) const;

  /// (u_left, v, u_right) of a point in the world.
  [[nodiscard]] Eigen::Vector3d project_point(const Pose& T_world_body,
                                              const Eigen::Vector3d& p_world) const;

 private:
  [[nodiscard]] cv::Mat render(const std::vector<Eigen::Vector3d>& rays,
                               const Pose& T_world_cam,
                               const std::optional<Eigen::Vector2d>& poster) const;

  StereoCalibration calibration_;
  RectifiedStereo stereo_;
  std::vector<Eigen::Vector3d> rays0_;  // per pixel, row by row
  std::vector<Eigen::Vector3d> rays1_;
  cv::Mat wall_;  // a centimeter per pixel
  cv::Mat poster_;
};

}  // namespace fleetloc
