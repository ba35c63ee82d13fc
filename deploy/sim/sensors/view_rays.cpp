#include "deploy/sim/sensors/view_rays.hpp"

namespace fleetloc {

ViewRays::ViewRays(const Camera& camera)
    : width_px_(camera.width_px),
      height_px_(camera.height_px),
      pixel_rad_(static_cast<float>(1.0 / camera.focal_px.mean())) {
  directions_.reserve(static_cast<std::size_t>(width_px_) * static_cast<std::size_t>(height_px_));
  for (int v = 0; v < height_px_; ++v) {
    for (int u = 0; u < width_px_; ++u) {
      const auto direction = unproject(camera, {u, v});
      directions_.push_back(direction ? direction->normalized().cast<float>().eval()
                                      : Eigen::Vector3f(Eigen::Vector3f::Zero()));
    }
  }
}

float ViewRays::vignetting(int u, int v, float corner_loss) const {
  const Eigen::Vector2f half(0.5F * static_cast<float>(width_px_),
                             0.5F * static_cast<float>(height_px_));
  const Eigen::Vector2f from_middle =
      Eigen::Vector2f(static_cast<float>(u), static_cast<float>(v)) - half;
  return 1.0F - corner_loss * from_middle.squaredNorm() / half.squaredNorm();
}

}  // namespace fleetloc
