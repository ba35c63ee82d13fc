#include "cloud/laser_map/build_map.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <utility>

#include <Eigen/Eigenvalues>

#include "cloud/laser_map/map_hash.hpp"
#include "cloud/laser_map/point_index.hpp"
#include "shared/concurrency/parallel_rows.hpp"

namespace fleetloc {
namespace {

/// Farther out neighbouring floats are more than a millimetre apart.
constexpr float kMaxCoordinate = 16384.0F;  // [m]

/// So that coordinates of voxels fit 32 bits.
constexpr double kFinestResolution = 1e-5;  // [m]
constexpr double kMaxResolution = 1e3;      // [m]

struct PointInVoxel {
  std::array<std::int32_t, 3> voxel;  // coordinates [resolution_m]
  Eigen::Vector3f p_map;
};

std::vector<PointInVoxel> sorted_by_voxel(const std::vector<Eigen::Vector3f>& points,
                                          double resolution_m) {
  assert(resolution_m >= kFinestResolution);
  std::vector<PointInVoxel> sorted;
  sorted.reserve(points.size());
  for (const Eigen::Vector3f& p_map : points) {
    if (!p_map.allFinite()) continue;
    if (p_map.cwiseAbs().maxCoeff() > kMaxCoordinate) {
      throw MapBuildError("a point is more than 16 km from the origin; shift the cloud towards it");
    }
    const Eigen::Vector3d voxel = (p_map.cast<double>() / resolution_m).array().floor();
    sorted.push_back({.voxel = {static_cast<std::int32_t>(voxel.x()),
                                static_cast<std::int32_t>(voxel.y()),
                                static_cast<std::int32_t>(voxel.z())},
                      .p_map = p_map});
  }
  std::ranges::stable_sort(sorted, {}, &PointInVoxel::voxel);
  return sorted;
}

std::size_t voxels_in(const std::vector<PointInVoxel>& sorted) {
  std::size_t voxels = 0;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    if (i == 0 || sorted[i].voxel != sorted[i - 1].voxel) ++voxels;
  }
  return voxels;
}

/// One point per voxel: the mean of its points.
std::vector<MapPoint> voxel_means(const std::vector<PointInVoxel>& sorted) {
  std::vector<MapPoint> means;
  means.reserve(voxels_in(sorted));
  for (auto begin = sorted.begin(); begin != sorted.end();) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    auto end = begin;
    for (; end != sorted.end() && end->voxel == begin->voxel; ++end) {
      sum += end->p_map.cast<double>();
    }
    means.push_back({.p_map = (sum / static_cast<double>(end - begin)).cast<float>()});
    begin = end;
  }
  return means;
}

/// Sets normal and planarity of `point` from the points at `indices`.
void fit_surface(const std::vector<MapPoint>& points,
                 const std::vector<std::size_t>& indices,
                 MapPoint& point) {
  const Eigen::Vector3d origin = point.p_map.cast<double>();  // sums of small numbers stay exact
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d sum_of_squares = Eigen::Matrix3d::Zero();
  for (const std::size_t index : indices) {
    const Eigen::Vector3d offset = points[index].p_map.cast<double>() - origin;
    sum += offset;
    sum_of_squares += offset * offset.transpose();
  }
  const auto count = static_cast<double>(indices.size());
  const Eigen::Matrix3d covariance = (sum_of_squares - sum * sum.transpose() / count) / count;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  const Eigen::Vector3d sigmas = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  if (sigmas(1) < 1e-6) return;  // on a line, where no direction is the normal
  point.normal = solver.eigenvectors().col(0).cast<float>();
  point.planarity = static_cast<float>(1.0 - sigmas(0) / sigmas(1));
}

void fit_surfaces(std::vector<MapPoint>& points,
                  const MapConfig& config,
                  const MapProgress& progress) {
  constexpr std::size_t kPointsPerRow = 512;
  constexpr std::size_t kPointsPerReport = 64 * kPointsPerRow;
  const PointIndex index(points);
  const auto fit = [&](std::size_t i) {  // reads positions, writes the rest of one point
    const auto indices = index.within(points[i].p_map.cast<double>(), config.normal_radius_m);
    if (indices.size() > static_cast<std::size_t>(config.min_neighbours)) {
      fit_surface(points, indices, points[i]);
    }
  };
  for (std::size_t begin = 0; begin < points.size(); begin += kPointsPerReport) {
    const std::size_t end = std::min(begin + kPointsPerReport, points.size());
    const auto rows = static_cast<int>((end - begin + kPointsPerRow - 1) / kPointsPerRow);
    for_each_row(rows, config.threads, [&](int row) {
      const std::size_t first = begin + static_cast<std::size_t>(row) * kPointsPerRow;
      const std::size_t last = std::min(first + kPointsPerRow, end);
      for (std::size_t i = first; i < last; ++i) fit(i);
    });
    if (progress) progress(end, points.size());
  }
}

MapInfo describe(const std::vector<MapPoint>& points, const std::string& frame, double resolution) {
  Eigen::Vector3f min = points.front().p_map;
  Eigen::Vector3f max = min;
  for (const MapPoint& point : points) {
    min = min.cwiseMin(point.p_map);
    max = max.cwiseMax(point.p_map);
  }
  return {.frame = frame,
          .resolution_m = resolution,
          .min = min.cast<double>(),
          .max = max.cast<double>(),
          .hash = map_hash(points)};
}

}  // namespace

MapConfig read_map_config(ConfigReader section) {
  return {.resolution_m = section.number("resolution_m", kFinestResolution, kMaxResolution),
          .normal_radius_m = section.positive("normal_radius_m"),
          .min_neighbours = section.integer("min_neighbours", 3, 1000),
          .threads = section.integer("threads", 1, 64)};
}

std::vector<Eigen::Vector3f> points_outside(std::vector<Eigen::Vector3f> points,
                                            const MapArea& area) {
  std::erase_if(points, [&area](const Eigen::Vector3f& point) {
    const Eigen::Array2d p = point.head<2>().cast<double>().array();
    return (p >= area.min.array()).all() && (p <= area.max.array()).all();
  });
  return points;
}

MapConfig at_resolution(MapConfig config, double resolution_m) {
  config.normal_radius_m *= resolution_m / config.resolution_m;
  config.resolution_m = resolution_m;
  return config;
}

LaserMap build_map(const std::vector<Eigen::Vector3f>& points,
                   const std::string& frame,
                   const MapConfig& config,
                   const MapProgress& progress) {
  std::vector<MapPoint> surface = voxel_means(sorted_by_voxel(points, config.resolution_m));
  if (surface.empty()) throw MapBuildError("no finite point to build a map of");
  fit_surfaces(surface, config, progress);
  const MapInfo info = describe(surface, frame, config.resolution_m);
  return {std::move(surface), info};
}

double planar_share(const LaserMap& map, double planarity) {
  const auto planar = std::ranges::count_if(map.points(), [planarity](const MapPoint& point) {
    return static_cast<double>(point.planarity) >= planarity;
  });
  return map.size() == 0 ? 0.0 : static_cast<double>(planar) / static_cast<double>(map.size());
}

}  // namespace fleetloc
