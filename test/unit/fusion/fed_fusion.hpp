#pragma once

#include <cmath>
#include <memory>
#include <string>

#include "deploy/config/default_config.hpp"
#include "robot/fusion/pose_fusion.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/core/time.hpp"
#include "shared/geometry/so3.hpp"
#include "shared/model/inertial.hpp"
#include "shared/model/localization_result.hpp"

namespace fleetloc {

inline PoseFusion::Config fusion_config() {
  auto reader = ConfigReader::from_string(default_config("robot"));
  return read_pose_fusion_config(reader.section("fusion"));
}

inline PoseFusion::Config coupled_config() {
  PoseFusion::Config config = fusion_config();
  config.formulation = PoseFusion::Formulation::kCoupled;
  return config;
}

/// Of EuRoC's IMU.
inline ImuNoise euroc_imu_noise() {
  return {.gyroscope_noise_density = 1.7e-4,
          .gyroscope_random_walk = 2.0e-5,
          .accelerometer_noise_density = 2.0e-3,
          .accelerometer_random_walk = 3.0e-3};
}

inline Timestamp at(double seconds) {
  return Timestamp{Duration{std::llround(seconds * 1e9)}};
}

/// A robot that drives a level circle at constant speed, facing forward; the IMU sees constants.
struct CircularDrive {
  double radius = 5.0;  ///< [m]
  double speed = 1.0;   ///< [m/s]

  [[nodiscard]] double turn_rate() const { return speed / radius; }

  /// In the frame of the circle, with velocity.
  [[nodiscard]] NavState state(double t) const {
    const double angle = turn_rate() * t;
    const Eigen::Quaterniond R = exp_so3({0.0, 0.0, angle});
    NavState state;
    state.T_odom_body = {R, {radius * std::sin(angle), radius * (1.0 - std::cos(angle)), 0.0}};
    state.v_odom = R * Eigen::Vector3d(speed, 0.0, 0.0);
    return state;
  }
  [[nodiscard]] Pose pose(double t) const { return state(t).T_odom_body; }

  [[nodiscard]] ImuSample imu(double t) const {
    return {.stamp = at(t),
            .angular_velocity = {0.0, 0.0, turn_rate()},
            .specific_force = {0.0, speed * turn_rate(), -kGravity.z()}};
  }
};

inline OdometryEstimate odometry(double t, const NavState& state) {
  OdometryEstimate estimate{.stamp = at(t), .state = state};
  estimate.covariance.diagonal().head<3>().setConstant(1e-6);
  estimate.covariance.diagonal().segment<3>(3).setConstant(1e-4);
  estimate.covariance.diagonal().segment<3>(6).setConstant(1e-4);
  estimate.covariance.diagonal().tail<6>().setConstant(1e-8);
  return estimate;
}

/// 3 cm and 0.3 deg, not the same in all directions.
inline Matrix6d answer_covariance() {
  Vector6d sigma;
  sigma << 0.004, 0.005, 0.006, 0.03, 0.02, 0.04;
  return sigma.cwiseAbs2().asDiagonal();
}

/// Of the cloud's window behind the answers below [s].
inline constexpr double kWindow = 20.0;

inline LocalizationResult answer(double t, const Pose& T_map_body) {
  LocalizationResult result;
  result.localizer = "cloud";
  result.status = LocalizationStatus::kLocalized;
  result.stamp = at(t);
  result.oldest_stamp = at(t - kWindow);
  result.T_map_body = T_map_body;
  result.covariance = answer_covariance();
  return result;
}

/// Some place of the circle in the map.
inline Pose true_T_map_odom() {
  return {exp_so3({0.002, -0.001, 0.8}), {10.0, -4.0, 1.5}};
}

/// A fusion that is fed with a drive: IMU at 100 Hz, frames at 10 Hz, each 50 ms late.
class FedFusion {
  std::unique_ptr<PoseFusion> owned_;

 public:
  explicit FedFusion(const PoseFusion::Config& config = fusion_config())
      : owned_(make_pose_fusion(euroc_imu_noise(), config)), fusion(*owned_) {}

  /// Drives on until `t`. The last output is kept.
  void drive_to(double t, bool with_odometry = true) {
    for (; 0.01 * ticks_ <= t + 1e-9; ++ticks_) {
      output = fusion.add_imu(drive.imu(0.01 * ticks_));
      if (with_odometry && ticks_ % 10 == 5) {
        const double stamp = 0.01 * (ticks_ - 5);
        fusion.add_odometry(odometry(stamp, drive.state(stamp)));
      }
    }
  }
  /// T_map_body of a frame if T_map_odom is the given one.
  AnswerOutcome answer_at(double t, const Pose& T_map_odom = true_T_map_odom()) {
    LocalizationResult result = answer(t, T_map_odom * drive.pose(t));
    result.session = session;
    return fusion.add_answer(result);
  }

  CircularDrive drive;
  PoseFusion& fusion;
  PoseEstimate output;
  SessionNumber session{};  ///< of the answers

 private:
  int ticks_ = 0;
};

}  // namespace fleetloc
