#include "cloud/locate/free_space.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace fleetloc {

struct FreeSpace::Ray {
  Eigen::Vector3d origin;
  Eigen::Vector3d direction;  // unit
  double end_m;               // along it

  [[nodiscard]] Eigen::Vector3d at(double along_m) const { return origin + along_m * direction; }
};

// Most of a ray is in cells without a surface, which cost no look into the map.
bool FreeSpace::is_blocked(const Eigen::Vector3d& viewpoint_map,
                           const Eigen::Vector3d& landmark_map,
                           double sigma_m) const {
  constexpr double kSigmas = 3.0;
  const Eigen::Vector3d way = landmark_map - viewpoint_map;
  const double length_m = way.norm();
  const Ray ray{
      viewpoint_map, way / length_m, length_m - std::max(config_.margin_m, kSigmas * sigma_m)};
  const double step_m = 0.5 * pyramid_.cell_m();
  for (double along_m = step_m; along_m < ray.end_m; along_m += step_m) {
    if (has_surface(ray.at(along_m)) && is_crossed(ray, along_m)) return true;
  }
  return false;
}

bool FreeSpace::has_surface(const Eigen::Vector3d& p_map) const {
  const double height_m = p_map.z() - pyramid_.ground().at(p_map.x(), p_map.y());
  const Eigen::Vector3i cell =
      floored(Eigen::Vector3d(p_map.x(), p_map.y(), height_m) / pyramid_.cell_m());
  return pyramid_.value(cell.x(), cell.y(), cell.z()) == MapPyramid::kFull;
}

// By the plane of the nearest point, if the map has points where the ray meets that plane.
bool FreeSpace::is_crossed(const Ray& ray, double along_m) const {
  const auto planar_near = [this](const Eigen::Vector3d& p_map, double radius_m) {
    std::optional<MapPoint> point;
    const auto near = map_.nearest(p_map, radius_m);
    if (near && map_.point(near->index).planarity >= config_.min_planarity) {
      point = map_.point(near->index);
    }
    return point;
  };
  const auto point = planar_near(ray.at(along_m), pyramid_.cell_m());
  if (!point) return false;
  const Eigen::Vector3d normal = point->normal.cast<double>();
  const double incidence = normal.dot(ray.direction);
  if (std::abs(incidence) < config_.min_incidence) return false;
  const double there_m = normal.dot(point->p_map.cast<double>() - ray.origin) / incidence;
  if (there_m <= 0.0 || there_m >= ray.end_m) return false;
  return planar_near(ray.at(there_m), config_.reach_m).has_value();
}

FreeSpace::Config read_free_space_config(ConfigReader section) {
  return {.margin_m = section.positive("margin_m"),
          .min_planarity = section.number("min_planarity", 0.0, 1.0),
          .min_incidence = section.number("min_incidence", 0.0, 1.0),
          .reach_m = section.positive("reach_m")};
}

}  // namespace fleetloc
