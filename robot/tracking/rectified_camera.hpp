#pragma once

#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <opencv2/core/types.hpp>

#include "shared/model/camera.hpp"

namespace fleetloc {

/// One camera of the pair: from pixels of its image to pixels of the rectified pair and back.
class RectifiedCamera {
 public:
  RectifiedCamera(Camera camera,
                  const Eigen::Quaterniond& R_body_cam,
                  const RectifiedStereo& stereo);

  /// Nothing where the result is outside of [0, kRectifiedSize).
  [[nodiscard]] std::optional<Eigen::Vector2d> rectify(const cv::Point2f& pixel) const;

  /// How the rectified pixel changes with the image's, over some pixels; nothing where one of them
  /// cannot be rectified.
  [[nodiscard]] std::optional<Eigen::Matrix2d> rectify_jacobian(const cv::Point2f& pixel) const;

  /// Nothing where the pixel would lie outside of the image.
  [[nodiscard]] std::optional<cv::Point2f> distort(const Eigen::Vector2d& rectified) const;

  [[nodiscard]] const Camera& camera() const { return camera_; }

 private:
  Camera camera_;
  Eigen::Quaterniond R_rectified_cam_;
  double focal_px_;
  Eigen::Vector2d center_px_;
};

}  // namespace fleetloc
