#include "shared/ros2/camera_info_codec.hpp"

#include <algorithm>

#include <idl/ros2/sensor_msgs.h>

#include "shared/ros2/pixel_encoding.hpp"
#include "shared/ros2/ros2_cdr.hpp"
#include "shared/ros2/ros2_fields.hpp"

namespace fleetloc {
namespace {

using sensor_msgs::msg::dds_::CameraInfo_;

constexpr std::size_t kMaxCoefficients = 14;  // those of OpenCV's largest model

Ros2Validity check_size(const CameraInfo_& info) {
  const std::uint64_t width = info.width();
  const std::uint64_t height = info.height();
  if (width == 0 || height == 0) return unexpected(Ros2Refusal::kEmptyImage);
  if (width > kMaxPixels || height > kMaxPixels || width * height > kMaxPixels) {
    return unexpected(Ros2Refusal::kTooManyPixels);
  }
  return {};
}

Ros2Validity check_camera_info_message(const CameraInfo_& info) {
  if (const Ros2Validity valid = check(info.header()); !valid) return valid;
  if (const Ros2Validity valid = check_text(info.distortion_model()); !valid) return valid;
  if (const Ros2Validity valid = check_size(info); !valid) return valid;
  if (info.d().size() > kMaxCoefficients) return unexpected(Ros2Refusal::kOutOfRange);
  for (const std::span<const double> values : {std::span<const double>(info.d()),
                                               std::span<const double>(info.k()),
                                               std::span<const double>(info.r()),
                                               std::span<const double>(info.p())}) {
    if (const Ros2Validity valid = check_finite(values); !valid) return valid;
  }
  const bool has_focal_length = info.k()[0] > 0.0 && info.k()[4] > 0.0;
  if (!has_focal_length) return unexpected(Ros2Refusal::kNotCalibrated);
  return {};
}

}  // namespace

CameraInfoMessage camera_info(const Camera& camera, const Ros2Header& header) {
  const bool is_equidistant = camera.distortion == Camera::Distortion::kEquidistant;
  CameraInfoMessage info;
  info.header = header;
  info.width_px = camera.width_px;
  info.height_px = camera.height_px;
  info.distortion_model = is_equidistant ? "equidistant" : "plumb_bob";
  info.coefficients.assign(camera.coefficients.begin(), camera.coefficients.end());
  if (!is_equidistant) info.coefficients.push_back(0.0);  // k3
  const double fx = camera.focal_px.x();
  const double fy = camera.focal_px.y();
  const double cx = camera.center_px.x();
  const double cy = camera.center_px.y();
  info.K = {fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0};
  info.R = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  info.P = {fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0};
  return info;
}

std::array<CameraInfoMessage, 2> camera_info(const StereoCalibration& pair) {
  const RectifiedStereo ideal = rectified(pair);
  const auto of = [&](const Camera& camera, const Pose& T_body_cam, double baseline_m) {
    CameraInfoMessage info = camera_info(camera, {});
    using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    const RowMajor R_rectified_cam =
        (ideal.T_body_cam0.R.inverse() * T_body_cam.R).toRotationMatrix();
    std::copy_n(R_rectified_cam.data(), info.R.size(), info.R.begin());
    const double f = ideal.focal_px;
    const Eigen::Vector2d& c = ideal.center_px;
    info.P = {f, 0.0, c.x(), -f * baseline_m, 0.0, f, c.y(), 0.0, 0.0, 0.0, 1.0, 0.0};
    return info;
  };
  return {of(pair.cam0, pair.T_body_cam0, 0.0), of(pair.cam1, pair.T_body_cam1, ideal.baseline_m)};
}

Bytes encode(const CameraInfoMessage& message) {
  CameraInfo_ info;
  info.header(to_ros2(message.header));
  info.height(static_cast<std::uint32_t>(message.height_px));
  info.width(static_cast<std::uint32_t>(message.width_px));
  info.distortion_model(message.distortion_model);
  info.d(message.coefficients);
  info.k(message.K);
  info.r(message.R);
  info.p(message.P);
  info.binning_x(message.binning_x);
  info.binning_y(message.binning_y);
  info.roi().x_offset(message.region.x_px);
  info.roi().y_offset(message.region.y_px);
  info.roi().height(message.region.height_px);
  info.roi().width(message.region.width_px);
  return to_cdr(info);
}

Ros2Decoded<CameraInfoMessage> decode_camera_info(std::span<const std::uint8_t> bytes) {
  const auto info = from_ros2_cdr<CameraInfo_>(bytes);
  if (!info) return unexpected(info.error());
  if (const Ros2Validity valid = check_camera_info_message(*info); !valid)
    return unexpected(valid.error());
  CameraInfoMessage message;
  message.header = from_ros2(info->header());
  message.width_px = static_cast<int>(info->width());
  message.height_px = static_cast<int>(info->height());
  message.distortion_model = info->distortion_model();
  message.coefficients = info->d();
  message.K = info->k();
  message.R = info->r();
  message.P = info->p();
  message.binning_x = std::max(info->binning_x(), 1U);
  message.binning_y = std::max(info->binning_y(), 1U);
  message.region = {.x_px = info->roi().x_offset(),
                    .y_px = info->roi().y_offset(),
                    .width_px = info->roi().width(),
                    .height_px = info->roi().height()};
  return message;
}

}  // namespace fleetloc
