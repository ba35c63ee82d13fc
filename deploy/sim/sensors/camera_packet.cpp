#include "deploy/sim/sensors/camera_packet.hpp"

#include "deploy/sim/world/float4.hpp"

namespace fleetloc {
void CameraPacket::set(std::size_t lane,
                       const Eigen::Vector3f& direction_cam,
                       std::uint8_t its_sun_sample) {
  direction_x[lane] = direction_cam.x();
  direction_y[lane] = direction_cam.y();
  direction_z[lane] = direction_cam.z();
  sun_sample[lane] = its_sun_sample;
}

ViewPacket in_map(const CameraPacket& packet, const CameraView& frame, float pixel_rad) {
  ViewPacket view{};
  view.sun_sample = packet.sun_sample;
  view.pixel_rad = pixel_rad;
  view.rays.origin_x.fill(frame.p_map.x());
  view.rays.origin_y.fill(frame.p_map.y());
  view.rays.origin_z.fill(frame.p_map.z());
  view.rays.min_m.fill(0.0F);
  const Eigen::Matrix3f& R = frame.R_map_cam;
  for (std::size_t i = 0; i < RayPacket::kSize; i += 4) {
    const Float4 x = load4(&packet.direction_x[i]);
    const Float4 y = load4(&packet.direction_y[i]);
    const Float4 z = load4(&packet.direction_z[i]);
    store4(R(0, 0) * x + R(0, 1) * y + R(0, 2) * z, &view.rays.direction_x[i]);
    store4(R(1, 0) * x + R(1, 1) * y + R(1, 2) * z, &view.rays.direction_y[i]);
    store4(R(2, 0) * x + R(2, 1) * y + R(2, 2) * z, &view.rays.direction_z[i]);
    const Int4 is_used = x * x + y * y + z * z > 0.0F;
    store4(is_used ? all4(kFarthestSeen_m) : all4(-1.0F), &view.rays.max_m[i]);
  }
  return view;
}

}  // namespace fleetloc
