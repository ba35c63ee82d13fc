#pragma once

#include <filesystem>
#include <fstream>
#include <functional>

#include "cloud/mapping/lidar_file.hpp"
#include "cloud/mapping/mapping_config.hpp"
#include "deploy/config/default_config.hpp"
#include "deploy/sim/sensors/lidar.hpp"
#include "shared/trajectory/tum_file.hpp"

namespace fleetloc {

/// Level ground between two walls, a thin pole, and boxes added to it.
class Yard {
 public:
  static constexpr float kWallY = 8.0F;
  static constexpr float kPoleHalfWidth = 0.05F;
  inline static const Eigen::Vector3f kPole{4.0F, 4.0F, 0.0F};

  Yard() {
    constexpr float kFar = 30.0F;
    add_quad({-kFar, -kFar, 0}, {kFar, -kFar, 0}, {kFar, kFar, 0}, {-kFar, kFar, 0});
    add_box({0, kWallY + 0.5F, 2.0F}, {20.0F, 0.5F, 2.0F});
    add_box({0, -12.0F, 2.0F}, {25.0F, 0.5F, 2.0F});
    add_box({kPole.x(), kPole.y(), 1.5F}, {kPoleHalfWidth, kPoleHalfWidth, 1.5F});
  }

  /// @param half  of the edges [m]
  void add_box(const Eigen::Vector3f& center, const Eigen::Vector3f& half) {
    const auto corner = [&](float x, float y, float z) -> Eigen::Vector3f {
      return center + half.cwiseProduct(Eigen::Vector3f(x, y, z));
    };
    for (const float s : {-1.0F, 1.0F}) {
      add_quad(corner(s, -1, -1), corner(s, 1, -1), corner(s, 1, 1), corner(s, -1, 1));
      add_quad(corner(-1, s, -1), corner(1, s, -1), corner(1, s, 1), corner(-1, s, 1));
      add_quad(corner(-1, -1, s), corner(1, -1, s), corner(1, 1, s), corner(-1, 1, s));
    }
  }

  [[nodiscard]] RayCaster caster() const { return RayCaster(mesh_); }

 private:
  void add_quad(const Eigen::Vector3f& a,
                const Eigen::Vector3f& b,
                const Eigen::Vector3f& c,
                const Eigen::Vector3f& d) {
    const auto first = static_cast<std::uint32_t>(mesh_.vertices.size());
    for (const auto& corner : {a, b, c, d}) mesh_.vertices.push_back(corner);
    mesh_.triangles.push_back({first, first + 1, first + 2});
    mesh_.triangles.push_back({first, first + 2, first + 3});
    mesh_.surfaces.insert(mesh_.surfaces.end(), 2, 0U);
  }

  Mesh mesh_;
};

inline constexpr Timestamp kSurveyStart{std::chrono::seconds(1000)};

inline LidarConfig survey_lidar() {
  constexpr double kDeg = 3.14159265358979 / 180.0;
  LidarConfig config;
  config.calibration = {.T_body_lidar = {.R = Eigen::Quaterniond::Identity(), .p = {0, 0, 0.3}},
                        .rate_hz = 10.0,
                        .columns = 900,
                        .rings = 16};
  config.lowest_rad = -15.0 * kDeg;
  config.highest_rad = 15.0 * kDeg;
  config.range_sigma_m = 0.02;
  config.min_m = 0.5;
  config.max_m = 100.0;
  config.max_incidence_rad = 86.0 * kDeg;
  return config;
}

/// 8 m along x within 8 s, 0.9 m above the ground.
inline Pose pose_in_yard(double time_s) {
  return {.R = Eigen::Quaterniond::Identity(), .p = {time_s - 4.0, 0.0, 0.9}};
}

/// Writes a survey as a dataset; `world(time_s)` is the scene of a scan.
inline std::filesystem::path written_survey(const std::filesystem::path& folder,
                                            std::uint64_t seed,
                                            const std::function<RayCaster(double)>& world) {
  constexpr int kScans = 80;
  std::filesystem::remove_all(folder);
  const SplineMotion motion = spline_through(grid_over(9.0, 0.1), pose_in_yard);
  const Lidar lidar(survey_lidar(), seed);
  LidarWriter writer(folder / "mav0" / "lidar0", lidar.config().calibration);
  for (std::uint64_t i = 0; i < kScans; ++i) {
    writer.add(lidar.scan(world(lidar.scan_time_s(i)), motion, kSurveyStart, i));
  }
  writer.finish();
  const auto poses = folder / "mav0" / "state_groundtruth_estimate0";
  std::filesystem::create_directories(poses);
  std::ofstream tum(poses / "data.tum");
  for (int i = 0; i <= 820; ++i) {
    const Duration after = from_seconds(0.01 * i);
    write_tum_line(tum, kSurveyStart + after, motion.at(to_seconds(after)).T_map_body);
  }
  return folder;
}

inline MappingConfig default_mapping_config() {
  return read_mapping_config(ConfigReader::from_string(default_config("map")));
}

}  // namespace fleetloc
