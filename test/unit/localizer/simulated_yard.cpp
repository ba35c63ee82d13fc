#include "simulated_yard.hpp"

#include "shared/core/counter_random.hpp"

namespace fleetloc {

LaserMap yard() {
  std::vector<MapPoint> points;
  const auto add = [&points](double x, double y, double z, const Eigen::Vector3f& normal) {
    const Eigen::Vector3d p_map(x, y, z);
    points.push_back({.p_map = p_map.cast<float>(), .normal = normal, .planarity = 1.0F});
  };
  for (int i = 0; i <= 200; ++i) {
    for (int j = 0; j <= 200; ++j) {
      add(0.1 * i - 10.0, 0.1 * j - 10.0, 0.0, Eigen::Vector3f::UnitZ());
      if (j > 30) continue;
      for (const double side : {-10.0, 10.0}) {
        add(0.1 * i - 10.0, side, 0.1 * j, Eigen::Vector3f::UnitY());
        add(side, 0.1 * i - 10.0, 0.1 * j, Eigen::Vector3f::UnitX());
      }
    }
  }
  return LaserMap(std::move(points), {.frame = "map", .resolution_m = 0.1});
}

std::vector<WindowLandmark> landmarks_of_yard(double cleared_share) {
  std::vector<WindowLandmark> landmarks;
  const auto add = [&landmarks](const Eigen::Vector3d& p_map) {
    const LandmarkId id{static_cast<unsigned>(landmarks.size())};
    landmarks.push_back({.id = id,
                         .p_map = p_map,
                         .viewpoint_map = {0.0, 0.0, 1.0},
                         .covariance = 4e-4 * Eigen::Matrix3d::Identity()});
  };
  const CounterRandom random(11, 0);
  for (unsigned i = 0; i < 300; ++i) {
    const Eigen::Vector3d noise = 0.02 * random.normal3(i);
    const double along = 0.06 * i - 9.0;
    const double side = i % 2 == 0 ? 10.0 : -10.0;
    if (i < 100) {
      const double height = i % 10 < 10.0 * cleared_share ? 0.0 : kSnow;
      add(Eigen::Vector3d(3.0 * along + 18.0, 0.3 * side, height) + noise);
    } else if (i < 200) {
      add(Eigen::Vector3d(side, along, 1.0) + noise);
    } else {
      add(Eigen::Vector3d(along, side, 1.5) + noise);
    }
  }
  return landmarks;
}

std::vector<WindowLandmark> moved(std::vector<WindowLandmark> landmarks, const Eigen::Vector3d& t) {
  for (WindowLandmark& landmark : landmarks) {
    landmark.p_map += t;
    landmark.viewpoint_map += t;
  }
  return landmarks;
}

}  // namespace fleetloc
