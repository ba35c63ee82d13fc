#pragma once

#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

#include "deploy/sim/sensors/light.hpp"
#include "shared/geometry/pose.hpp"

namespace fleetloc {

/// What is farther away is not seen.
inline constexpr float kFarthestSeen_m = 1000.0F;

/// Viewing rays of pixels, in the camera's frame.
struct CameraPacket {
  RayPacket::Lanes<float> direction_x, direction_y, direction_z;  ///< zero in unused lanes
  RayPacket::Lanes<std::uint8_t> sun_sample;

  void set(std::size_t lane, const Eigen::Vector3f& direction_cam, std::uint8_t its_sun_sample);
};

/// The sample of the sun that a pixel's shadow ray is cast to.
inline std::uint8_t sun_sample(int u, int v) {
  return static_cast<std::uint8_t>((u + v) % kSunSamples);
}

struct CameraView {
  explicit CameraView(const Pose& T_map_cam)
      : R_map_cam(T_map_cam.R.toRotationMatrix().cast<float>()), p_map(T_map_cam.p.cast<float>()) {}
  Eigen::Matrix3f R_map_cam;
  Eigen::Vector3f p_map;
};

ViewPacket in_map(const CameraPacket& packet, const CameraView& frame, float pixel_rad);

}  // namespace fleetloc
