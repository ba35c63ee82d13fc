#include "deploy/sim/sensors/lidar.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "shared/core/counter_random.hpp"
#include "shared/geometry/angle.hpp"
#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

enum Stream : std::uint64_t { kRange = 0x6c69646172'00, kDropout };

double share_of_one(ConfigReader& reader, const std::string& key) {
  const auto value = reader.get<double>(key);
  if (!(value >= 0.0 && value < 1.0)) throw ConfigError(key + ": must be in [0, 1)");
  return value;
}

/// Direction of a ring and column, in the lidar's frame.
Eigen::Vector3d direction(const LidarConfig& config, int column, int ring) {
  const LidarCalibration& lidar = config.calibration;
  const double azimuth = 2.0 * std::numbers::pi * column / lidar.columns;
  const double step =
      lidar.rings > 1 ? (config.highest_rad - config.lowest_rad) / (lidar.rings - 1) : 0.0;
  const double elevation = config.lowest_rad + ring * step;
  return {std::cos(elevation) * std::cos(azimuth),
          std::cos(elevation) * std::sin(azimuth),
          std::sin(elevation)};
}

Pose read_pose(ConfigReader& reader) {
  const auto p = reader.get<std::vector<double>>("position_m");
  const auto angles = reader.get<std::vector<double>>("roll_pitch_yaw_deg");
  if (p.size() != 3 || angles.size() != 3) {
    throw ConfigError("position_m, roll_pitch_yaw_deg: expected three numbers each");
  }
  return {.R = Eigen::AngleAxisd(kRadPerDeg * angles[2], Eigen::Vector3d::UnitZ()) *
               Eigen::AngleAxisd(kRadPerDeg * angles[1], Eigen::Vector3d::UnitY()) *
               Eigen::AngleAxisd(kRadPerDeg * angles[0], Eigen::Vector3d::UnitX()),
          .p = {p[0], p[1], p[2]}};
}

}  // namespace

LidarConfig read_lidar_config(ConfigReader section) {
  constexpr int kMaxColumns = 65536;
  LidarConfig config;
  config.calibration = {.T_body_lidar = read_pose(section),
                        .rate_hz = section.positive("rate_hz"),
                        .columns = section.integer("columns", 4, kMaxColumns),
                        .rings = section.integer("rings", 1, 128)};
  config.lowest_rad = kRadPerDeg * section.get<double>("lowest_deg");
  config.highest_rad = kRadPerDeg * section.get<double>("highest_deg");
  config.range_sigma_m = share_of_one(section, "range_sigma_m");
  config.dropout_share = share_of_one(section, "dropout_share");
  config.min_m = section.positive("min_m");
  config.max_m = section.positive("max_m");
  config.max_incidence_rad = kRadPerDeg * section.positive("max_incidence_deg");
  return config;
}

Lidar::Lidar(LidarConfig config, std::uint64_t seed) : config_(std::move(config)), seed_(seed) {}

double Lidar::scan_time_s(std::uint64_t index) const {
  return static_cast<double>(index) / config_.calibration.rate_hz;
}

LidarScan Lidar::scan(const RayCaster& world,
                      const SplineMotion& motion,
                      Timestamp start,
                      std::uint64_t index) const {
  const double time_s = scan_time_s(index);
  const LidarCalibration& lidar = config_.calibration;
  LidarScan scan{.stamp = start + from_seconds(time_s), .points = {}};
  for (int column = 0; column < lidar.columns; ++column) {
    const Pose T_map_body = motion.at(time_s + lidar.column_time_s(column)).T_map_body;
    measure_column(world, T_map_body * lidar.T_body_lidar, index, column, scan);
  }
  return scan;
}

void Lidar::measure_column(const RayCaster& world,
                           const Pose& T_map_lidar,
                           std::uint64_t index,
                           int column,
                           LidarScan& scan) const {
  const CounterRandom noise(seed_, kRange);
  const CounterRandom dropout(seed_, kDropout);
  const Eigen::Vector3f origin = T_map_lidar.p.cast<float>();
  const int rings = config_.calibration.rings;
  const double min_cosine = std::cos(config_.max_incidence_rad);
  for (int first = 0; first < rings; first += RayPacket::kSize) {
    RayPacket rays{};
    rays.max_m.fill(-1.0F);
    const int used = std::min(RayPacket::kSize, rings - first);
    std::array<Eigen::Vector3d, RayPacket::kSize> directions;
    for (int lane = 0; lane < used; ++lane) {
      const auto i = static_cast<std::size_t>(lane);
      directions[i] = direction(config_, column, first + lane);
      const Eigen::Vector3f along = (T_map_lidar.R * directions[i]).cast<float>();
      rays.origin_x[i] = origin.x();
      rays.origin_y[i] = origin.y();
      rays.origin_z[i] = origin.z();
      rays.direction_x[i] = along.x();
      rays.direction_y[i] = along.y();
      rays.direction_z[i] = along.z();
      rays.min_m[i] = static_cast<float>(config_.min_m);
      rays.max_m[i] = static_cast<float>(config_.max_m);
    }
    const HitPacket hits = world.first_hits(rays);
    for (int lane = 0; lane < used; ++lane) {
      const auto i = static_cast<std::size_t>(lane);
      if (hits.distance_m[i] == HitPacket::kNone) continue;
      const double cosine =
          -(hits.normal_x[i] * rays.direction_x[i] + hits.normal_y[i] * rays.direction_y[i] +
            hits.normal_z[i] * rays.direction_z[i]);
      const int ray = column * rings + first + lane;
      const auto item = static_cast<std::uint64_t>(ray);
      if (cosine < min_cosine || dropout.uniform(index, item) < config_.dropout_share) continue;
      const double range = static_cast<double>(hits.distance_m[i]) +
                           config_.range_sigma_m * noise.normal(index, item);
      scan.points.push_back({.p_lidar = (range * directions[i]).cast<float>(),
                             .column = static_cast<std::uint16_t>(column),
                             .ring = static_cast<std::uint8_t>(first + lane)});
    }
  }
}

}  // namespace fleetloc
