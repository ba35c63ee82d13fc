#include "cloud/locate/above_ground.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <set>

namespace fleetloc {
namespace {

double distance(const SeenLandmark& landmark) {
  return (landmark.p - landmark.viewpoint).head<2>().norm();
}

double depth_below_camera(const SeenLandmark& landmark) {
  return landmark.viewpoint.z() - landmark.p.z();
}

}  // namespace

std::optional<double> camera_height(const std::vector<SeenLandmark>& landmarks,
                                    const GroundConfig& config) {
  std::vector<double> depths;
  std::size_t near = 0;
  for (const SeenLandmark& landmark : landmarks) {
    if (distance(landmark) > config.near_m) continue;
    ++near;
    if (depth_below_camera(landmark) > 0.0) depths.push_back(depth_below_camera(landmark));
  }
  std::ranges::sort(depths);
  std::size_t most = 0;
  std::optional<double> height;
  for (auto begin = depths.begin(); begin != depths.end(); ++begin) {
    const auto end = std::lower_bound(begin, depths.end(), *begin + config.band_m);
    const auto count = static_cast<std::size_t>(end - begin);
    if (count <= most) continue;
    most = count;
    height = begin[static_cast<std::ptrdiff_t>(count / 2)];
  }
  const bool stands_out = static_cast<double>(most) >= config.min_share * static_cast<double>(near);
  return stands_out ? height : std::nullopt;
}

std::vector<SeenLandmark> above_ground(const std::vector<SeenLandmark>& landmarks,
                                       const GroundConfig& config) {
  const auto height = camera_height(landmarks, config);
  if (!height) return landmarks;
  std::vector<SeenLandmark> result;
  std::ranges::copy_if(landmarks, std::back_inserter(result), [&](const SeenLandmark& landmark) {
    return *height - depth_below_camera(landmark) >
           config.band_m + config.max_slope * distance(landmark);
  });
  return result;
}

std::vector<SeenLandmark> spread_out(const std::vector<SeenLandmark>& landmarks, double spacing_m) {
  std::set<std::array<int, 3>> taken;
  std::vector<SeenLandmark> result;
  for (const SeenLandmark& landmark : landmarks) {
    const Eigen::Vector3i block = floored(landmark.p / spacing_m);
    if (taken.insert({block.x(), block.y(), block.z()}).second) result.push_back(landmark);
  }
  return result;
}

GroundConfig read_ground_config(ConfigReader section) {
  return {.near_m = section.positive("near_m"),
          .band_m = section.positive("band_m"),
          .min_share = section.number("min_share", 0.0, 1.0),
          .max_slope = section.number("max_slope", 0.0, 1.0)};
}

}  // namespace fleetloc
