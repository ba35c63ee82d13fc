#include "robot/calibration/camera_info.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "robot/calibration/rotation_check.hpp"

namespace fleetloc {
namespace {

constexpr std::uint32_t kMaxSize = 16384;  // [px]
constexpr double kSamePixel = 1e-3;        // of two rectified cameras [px]

using Matrix3RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

Eigen::Matrix3d rotation_of(const CameraInfo& info) {
  return Eigen::Map<const Matrix3RowMajor>(info.R.data());
}

template <typename Numbers>
bool all_finite(const Numbers& numbers) {
  return std::ranges::all_of(numbers, [](double number) { return std::isfinite(number); });
}

expected<void, CameraInfoRefusal> check(const CameraInfo& info) {
  using enum CameraInfoRefusal;
  if (info.width_px == 0 || info.height_px == 0 || info.width_px > kMaxSize ||
      info.height_px > kMaxSize) {
    return unexpected(kSize);
  }
  if (!all_finite(info.K) || !all_finite(info.D) || !all_finite(info.R) || !all_finite(info.P)) {
    return unexpected(kNotFinite);
  }
  if (!(info.K[0] > 0.0 && info.K[4] > 0.0 && info.P[0] > 0.0 && info.P[5] > 0.0)) {
    return unexpected(kFocalLength);
  }
  if (!is_rotation(rotation_of(info))) return unexpected(kRotation);
  return {};
}

// plumb_bob is k1 k2 p1 p2 k3, rational_polynomial has k4 k5 k6 behind it.
expected<void, CameraInfoRefusal> set_distortion(const CameraInfo& info, Camera& camera) {
  using enum CameraInfoRefusal;
  const bool equidistant =
      info.distortion_model == "equidistant" || info.distortion_model == "fisheye";
  const bool radial =
      info.distortion_model == "plumb_bob" || info.distortion_model == "rational_polynomial";
  if (info.D.empty()) return {};
  if (!equidistant && !radial) return unexpected(kDistortionModel);
  const bool higher =
      std::ranges::any_of(info.D.begin() + std::min<std::ptrdiff_t>(4, std::ssize(info.D)),
                          info.D.end(),
                          [](double coefficient) { return coefficient != 0.0; });
  if (info.D.size() < 4 || higher) return unexpected(kDistortionCoefficients);
  if (equidistant) camera.distortion = Camera::Distortion::kEquidistant;
  camera.coefficients = Eigen::Vector4d(info.D.data());
  return {};
}

expected<Camera, CameraInfoRefusal> raw_camera(const CameraInfo& info) {
  Camera camera{.width_px = static_cast<int>(info.width_px),
                .height_px = static_cast<int>(info.height_px),
                .focal_px = {info.K[0], info.K[4]},
                .center_px = {info.K[2], info.K[5]}};
  if (const auto set = set_distortion(info, camera); !set) return unexpected(set.error());
  return camera;
}

Camera rectified_camera(const CameraInfo& info) {
  return {.width_px = static_cast<int>(info.width_px),
          .height_px = static_cast<int>(info.height_px),
          .focal_px = {info.P[0], info.P[5]},
          .center_px = {info.P[2], info.P[6]}};
}

// Principal points may differ along x, where the pair converges at a finite depth.
bool is_pair(const CameraInfo& left, const CameraInfo& right) {
  for (const std::size_t i : {0U, 5U, 6U}) {
    if (std::abs(left.P[i] - right.P[i]) > kSamePixel) return false;
  }
  return std::abs(left.P[3]) < kSamePixel && std::abs(left.P[7]) < kSamePixel &&
         std::abs(right.P[7]) < kSamePixel;
}

}  // namespace

std::string_view name(CameraInfoRefusal reason) {
  switch (reason) {
    case CameraInfoRefusal::kSize:
      return "size";
    case CameraInfoRefusal::kNotFinite:
      return "not_finite";
    case CameraInfoRefusal::kFocalLength:
      return "focal_length";
    case CameraInfoRefusal::kDistortionModel:
      return "distortion_model";
    case CameraInfoRefusal::kDistortionCoefficients:
      return "distortion_coefficients";
    case CameraInfoRefusal::kRotation:
      return "rotation";
    case CameraInfoRefusal::kNotAPair:
      return "not_a_pair";
    case CameraInfoRefusal::kBaseline:
      return "baseline";
  }
  return "unknown";
}

expected<StereoCalibration, CameraInfoRefusal> stereo_calibration(const CameraInfo& left,
                                                                  const CameraInfo& right,
                                                                  ImageKind images,
                                                                  const Pose& T_body_cam0) {
  for (const CameraInfo& info : {left, right}) {
    if (const auto valid = check(info); !valid) return unexpected(valid.error());
  }
  if (!is_pair(left, right)) return unexpected(CameraInfoRefusal::kNotAPair);
  const double baseline_m = -right.P[3] / right.P[0];
  if (!(baseline_m > 1e-3)) return unexpected(CameraInfoRefusal::kBaseline);
  const Pose T_rectified0_rectified1{.R = Eigen::Quaterniond::Identity(),
                                     .p = {baseline_m, 0.0, 0.0}};
  StereoCalibration calibration{.cam0 = rectified_camera(left),
                                .cam1 = rectified_camera(right),
                                .T_body_cam0 = T_body_cam0,
                                .T_body_cam1 = T_body_cam0 * T_rectified0_rectified1};
  if (images == ImageKind::kRectified) return calibration;
  const auto cam0 = raw_camera(left);
  if (!cam0) return unexpected(cam0.error());
  const auto cam1 = raw_camera(right);
  if (!cam1) return unexpected(cam1.error());
  calibration.cam0 = *cam0;
  calibration.cam1 = *cam1;
  const auto turn_of = [](const CameraInfo& info) {
    return Pose{.R = Eigen::Quaterniond(rotation_of(info)).normalized(),
                .p = Eigen::Vector3d::Zero()};
  };
  calibration.T_body_cam1 =
      T_body_cam0 * inverse(turn_of(left)) * T_rectified0_rectified1 * turn_of(right);
  return calibration;
}

}  // namespace fleetloc
