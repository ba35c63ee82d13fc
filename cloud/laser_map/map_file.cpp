#include "cloud/laser_map/map_file.hpp"

#include <array>
#include <charconv>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "cloud/laser_map/map_hash.hpp"
#include "cloud/point_cloud/point_cloud_file.hpp"
#include "shared/config/config_reader.hpp"

namespace fleetloc {
namespace {

const std::vector<std::string> kFields = {
    "x", "y", "z", "normal_x", "normal_y", "normal_z", "planarity"};

struct SavedInfo {
  MapInfo info;  // without hash
  std::size_t points = 0;
  std::string hash;
};

PointTable to_table(const LaserMap& map) {
  PointTable table(static_cast<Eigen::Index>(map.size()), 7);
  Eigen::Index row = 0;
  for (const MapPoint& point : map.points()) {
    table.row(row++) << point.p_map.transpose(), point.normal.transpose(), point.planarity;
  }
  return table;
}

std::vector<MapPoint> from_table(const PointTable& table) {
  std::vector<MapPoint> points;
  points.reserve(static_cast<std::size_t>(table.rows()));
  for (const auto& row : table.rowwise()) {
    points.push_back({.p_map = row.segment<3>(0).transpose(),
                      .normal = row.segment<3>(3).transpose(),
                      .planarity = row(6)});
  }
  return points;
}

Eigen::Vector3d read_vector(ConfigReader& reader, const std::string& key) {
  const auto values = reader.get<std::vector<double>>(key);
  if (values.size() != 3) throw ConfigError(key + ": expected three numbers");
  return {values[0], values[1], values[2]};
}

SavedInfo read_info(const std::filesystem::path& file) {
  auto reader = ConfigReader::from_file(file);
  SavedInfo saved;
  saved.info.frame = reader.get<std::string>("frame");
  saved.info.resolution_m = reader.positive("resolution_m");
  saved.points = reader.get<std::size_t>("points");
  saved.info.min = read_vector(reader, "min_m");
  saved.info.max = read_vector(reader, "max_m");
  saved.hash = reader.get<std::string>("content_hash");
  reader.expect_fully_read();
  return saved;
}

/// The shortest text that is read back as the same number.
std::string to_text(double value) {
  std::array<char, 32> text{};
  char* const end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

std::string to_text(const Eigen::Vector3d& v) {
  return "[" + to_text(v.x()) + ", " + to_text(v.y()) + ", " + to_text(v.z()) + "]";
}

LaserMap checked(std::vector<MapPoint> points, const SavedInfo& saved) {
  if (points.size() != saved.points) {
    throw MapFileError("holds " + std::to_string(points.size()) + " points instead of " +
                       std::to_string(saved.points));
  }
  MapInfo info = saved.info;
  info.hash = map_hash(points);
  if (to_string(info.hash) != saved.hash) {
    throw MapFileError("its content hash is " + to_string(info.hash) + " instead of " + saved.hash +
                       ": the file is damaged or belongs to another map");
  }
  return {std::move(points), std::move(info)};
}

}  // namespace

std::filesystem::path map_info_file(const std::filesystem::path& pcd_file) {
  return std::filesystem::path(pcd_file).replace_extension(".yaml");
}

void save_map(const LaserMap& map, const std::filesystem::path& pcd_file) {
  try {
    write_pcd(pcd_file, kFields, to_table(map));
  } catch (const PointCloudError& error) {
    throw MapFileError(error.what());
  }
  const MapInfo& info = map.info();
  YAML::Emitter frame;
  frame << YAML::DoubleQuoted << info.frame;
  std::ofstream yaml(map_info_file(pcd_file));
  yaml << "# Belongs to " << pcd_file.filename().string() << ", written by fleetloc.\n"
       << "frame: " << frame.c_str() << '\n'
       << "resolution_m: " << to_text(info.resolution_m) << '\n'
       << "points: " << map.size() << '\n'
       << "min_m: " << to_text(info.min) << '\n'
       << "max_m: " << to_text(info.max) << '\n'
       << "content_hash: \"" << to_string(info.hash) << "\"\n";
  yaml.close();
  if (!yaml) throw MapFileError(map_info_file(pcd_file).string() + ": cannot be written");
}

LaserMap load_map(const std::filesystem::path& pcd_file) {
  const auto info_file = map_info_file(pcd_file);
  if (!std::filesystem::is_regular_file(pcd_file)) {
    throw MapFileError(pcd_file.string() + ": no such map");
  }
  if (!std::filesystem::is_regular_file(info_file)) {
    throw MapFileError(info_file.string() + ": missing; it belongs to the map " +
                       pcd_file.string());
  }
  try {
    const SavedInfo saved = read_info(info_file);
    return checked(from_table(read_point_fields(pcd_file, kFields)), saved);
  } catch (const MapFileError& error) {
    throw MapFileError(pcd_file.string() + ": " + error.what());
  } catch (const std::runtime_error& error) {  // of the YAML file or of PCD; names its file
    throw MapFileError(error.what());
  }
}

}  // namespace fleetloc
