#include "cloud/laser_map/map_regions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "shared/core/ids.hpp"

namespace fleetloc {
namespace {

constexpr double kFar_m = 1e6;

/// @param form  as a message shows it, "[x, y, radius]"
template <std::size_t N>
std::array<double, N> numbers(ConfigReader& region,
                              const std::string& key,
                              const std::string& form) {
  const auto values = region.get<std::vector<double>>(key);
  const bool are_near =
      std::ranges::all_of(values, [](double value) { return std::abs(value) <= kFar_m; });
  if (values.size() != N || !are_near) region.fail(key, "expected " + form + " in m");
  std::array<double, N> result{};
  std::ranges::copy(values, result.begin());
  return result;
}

void read_rectangle(ConfigReader& from, MapRegion& region) {
  const auto [x_min, y_min, x_max, y_max] =
      numbers<4>(from, "rectangle", "[x_min, y_min, x_max, y_max]");
  if (x_min >= x_max || y_min >= y_max) from.fail("rectangle", "is empty");
  region.min_map = {x_min, y_min};
  region.max_map = {x_max, y_max};
}

void read_circle(ConfigReader& from, MapRegion& region) {
  const auto [x, y, radius_m] = numbers<3>(from, "circle", "[x, y, radius]");
  if (radius_m <= 0.0) from.fail("circle", "is empty");
  region = MapRegion::circle({x, y}, radius_m);
}

void read_heights(ConfigReader& from, MapRegion& region) {
  const auto [lowest_m, highest_m] = numbers<2>(from, "heights", "[lowest, highest]");
  if (lowest_m >= highest_m) from.fail("heights", "is empty");
  region.lowest_m = lowest_m;
  region.highest_m = highest_m;
}

MapRegion read_region(ConfigReader from) {
  MapRegion region;
  const bool has_circle = from.has("circle");
  const bool has_rectangle = from.has("rectangle");
  if (has_circle && has_rectangle) from.fail("circle", "there is a rectangle, too");
  if (has_circle) read_circle(from, region);
  if (has_rectangle) read_rectangle(from, region);
  if (from.has("heights")) read_heights(from, region);
  return region;
}

}  // namespace

MapRegion MapRegion::circle(const Eigen::Vector2d& center_map, double radius_m) {
  const Eigen::Vector2d reach = Eigen::Vector2d::Constant(radius_m);
  return {.min_map = center_map - reach, .max_map = center_map + reach, .radius_m = radius_m};
}

MapRegion MapRegion::nowhere() {
  return {.min_map = Eigen::Vector2d::Constant(kFar_m),
          .max_map = Eigen::Vector2d::Constant(-kFar_m)};
}

bool MapRegion::has(const Eigen::Vector2d& p_map, double margin_m) const {
  const bool is_inside = (p_map.array() >= min_map.array() - margin_m).all() &&
                         (p_map.array() <= max_map.array() + margin_m).all();
  if (!is_inside || radius_m == kUnlimited) return is_inside;
  return (p_map - 0.5 * (min_map + max_map)).norm() <= radius_m + margin_m;
}

std::filesystem::path map_regions_file(const std::filesystem::path& pcd_file) {
  return std::filesystem::path(pcd_file).replace_extension(".regions.yaml");
}

MapRegions load_map_regions(const std::filesystem::path& pcd_file) {
  const std::filesystem::path file = map_regions_file(pcd_file);
  if (!std::filesystem::exists(file)) return {};
  return read_map_regions(ConfigReader::from_file(file));
}

MapRegions read_map_regions(ConfigReader regions) {
  MapRegions result;
  for (const std::string& name : regions.keys()) {
    if (!is_valid_id(name)) regions.fail(name, "is not 1 to 32 of A-Z a-z 0-9 _ -");
    ConfigReader region = regions.section(name);
    if (region.keys().empty()) regions.fail(name, "expected rectangle, circle or heights");
    result[name] = read_region(region);
  }
  regions.expect_fully_read();
  return result;
}

}  // namespace fleetloc
