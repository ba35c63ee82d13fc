#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "shared/model/camera.hpp"

namespace fleetloc {

/// Where the pixels of a camera look, by its exact model, computed once.
class ViewRays {
 public:
  explicit ViewRays(const Camera& camera);

  [[nodiscard]] int width_px() const { return width_px_; }
  [[nodiscard]] int height_px() const { return height_px_; }

  /// Of a pixel, by rows.
  [[nodiscard]] std::size_t index(int u, int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width_px_) +
           static_cast<std::size_t>(u);
  }
  /// Unit length, in the camera's frame; zero where the distortion cannot be inverted.
  [[nodiscard]] const Eigen::Vector3f& direction(int u, int v) const {
    return directions_[index(u, v)];
  }
  /// Halfway from one pixel to a neighbour, both by their index.
  [[nodiscard]] Eigen::Vector3f direction_between(std::size_t pixel, std::size_t next) const {
    return (directions_[pixel] + directions_[next]).normalized();
  }

  [[nodiscard]] float pixel_rad() const { return pixel_rad_; }  ///< about the image's middle

  /// Share of the light that arrives, for a lens that loses `corner_loss` of it in the corners.
  [[nodiscard]] float vignetting(int u, int v, float corner_loss) const;

 private:
  int width_px_;
  int height_px_;
  float pixel_rad_;
  std::vector<Eigen::Vector3f> directions_;
};

}  // namespace fleetloc
