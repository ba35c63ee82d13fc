#include "robot/tracking/rectified_camera.hpp"

#include <utility>

namespace fleetloc {

RectifiedCamera::RectifiedCamera(Camera camera,
                                 const Eigen::Quaterniond& R_body_cam,
                                 const RectifiedStereo& stereo)
    : camera_(std::move(camera)),
      R_rectified_cam_(stereo.T_body_cam0.R.conjugate() * R_body_cam),
      focal_px_(stereo.focal_px),
      center_px_(stereo.center_px) {}

std::optional<Eigen::Vector2d> RectifiedCamera::rectify(const cv::Point2f& pixel) const {
  const auto direction = unproject(camera_, Eigen::Vector2d(pixel.x, pixel.y));
  if (!direction) return std::nullopt;
  const Eigen::Vector3d ray = R_rectified_cam_ * *direction;
  if (ray.z() <= 0.0) return std::nullopt;
  const Eigen::Vector2d rectified = center_px_ + ray.head<2>() * (focal_px_ / ray.z());
  const bool inside = rectified.minCoeff() >= 0.0 && rectified.maxCoeff() < kRectifiedSize;
  if (!inside) return std::nullopt;
  return rectified;
}

std::optional<Eigen::Matrix2d> RectifiedCamera::rectify_jacobian(const cv::Point2f& pixel) const {
  constexpr float kStep_px = 2.0F;
  Eigen::Matrix2d J;
  for (int axis = 0; axis < 2; ++axis) {
    const cv::Point2f step = axis == 0 ? cv::Point2f(kStep_px, 0.0F) : cv::Point2f(0.0F, kStep_px);
    const auto after = rectify(pixel + step);
    const auto before = rectify(pixel - step);
    if (!after || !before) return std::nullopt;
    J.col(axis) = (*after - *before) / (2.0 * static_cast<double>(kStep_px));
  }
  return J;
}

std::optional<cv::Point2f> RectifiedCamera::distort(const Eigen::Vector2d& rectified) const {
  const Eigen::Vector2d ideal = (rectified - center_px_) / focal_px_;
  const auto pixel = project(camera_, R_rectified_cam_.conjugate() * ideal.homogeneous());
  if (!pixel) return std::nullopt;
  const bool inside = pixel->minCoeff() >= 0.0 && pixel->x() <= camera_.width_px - 1.0 &&
                      pixel->y() <= camera_.height_px - 1.0;
  if (!inside) return std::nullopt;
  return cv::Point2f(static_cast<float>(pixel->x()), static_cast<float>(pixel->y()));
}

}  // namespace fleetloc
