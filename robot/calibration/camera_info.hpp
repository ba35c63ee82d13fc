#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "shared/core/expected.hpp"
#include "shared/model/camera.hpp"

namespace fleetloc {

/// The values of a ROS 2 CameraInfo; matrices row by row.
struct CameraInfo {
  std::uint32_t width_px = 0;
  std::uint32_t height_px = 0;
  std::string distortion_model;  ///< "plumb_bob", "rational_polynomial", "equidistant", "fisheye"
  std::vector<double> D;         ///< of it; empty: none
  std::array<double, 9> K{};     ///< of the image as the sensor has taken it [px]
  std::array<double, 9> R{};     ///< R_rectified_cam
  std::array<double, 12> P{};    ///< of the rectified image [px]; P[3] is -focal length * baseline
};

/// Which images are published beside it.
enum class ImageKind {
  kRaw,        ///< as taken: K, D and R hold
  kRectified,  ///< P holds
};

/// Why a pair of CameraInfo cannot be used.
enum class CameraInfoRefusal {
  kSize,                    ///< zero, or beyond 16384 px
  kNotFinite,               ///< K, D, R or P
  kFocalLength,             ///< not positive
  kDistortionModel,         ///< unknown
  kDistortionCoefficients,  ///< wrong number, or higher ones than k1, k2, p1, p2 that are not zero
  kRotation,                ///< R is not a rotation
  kNotAPair,                ///< P of both differs in more than the baseline
  kBaseline,                ///< not positive: P[3] of the right one is not below zero
};

/// Name in messages, e.g. "baseline".
std::string_view name(CameraInfoRefusal reason);

/// @param T_body_cam0  of the left camera: of the image as it is published, raw or rectified
expected<StereoCalibration, CameraInfoRefusal> stereo_calibration(const CameraInfo& left,
                                                                  const CameraInfo& right,
                                                                  ImageKind images,
                                                                  const Pose& T_body_cam0);

}  // namespace fleetloc
