#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "shared/model/camera.hpp"

namespace fleetloc {

/// Viewing rays of the pixels of a camera, by its exact model, computed once.
class ViewRays {
 public:
  explicit ViewRays(const Camera& camera);

  [[nodiscard]] int width_px() const { return width_px_; }
  [[nodiscard]] int height_px() const { return height_px_; }

  /// Index of a pixel, row by row.
  [[nodiscard]] std::size_t index(int u, int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width_px_) +
           static_cast<std::size_t>(u);
  }
  /// Unit length, in the camera's frame; zero where the distortion cannot be inverted.
  [[nodiscard]] const Eigen::Vector3f& direction(int u, int v) const {
    return directions_[index(u, v)];
  }
  /// Ray halfway between two neighbouring pixels, given by their indices; unit length.
  [[nodiscard]] Eigen::Vector3f direction_between(std::size_t pixel, std::size_t next) const {
    return (directions_[pixel] + directions_[next]).normalized();
  }

  /// Angle of a pixel at the image's center.
  [[nodiscard]] float pixel_rad() const { return pixel_rad_; }

  /// Vignetting: share of the light that arrives, 1 - `corner_loss` in the corners.
  [[nodiscard]] float vignetting(int u, int v, float corner_loss) const;

 private:
  int width_px_;
  int height_px_;
  float pixel_rad_;
  std::vector<Eigen::Vector3f> directions_;
};

}  // namespace fleetloc
