#pragma once

#include <random>
#include <vector>

#include "deploy/sim/room/simulated_run.hpp"
#include "robot/inertial/inertial_window.hpp"

namespace fleetloc {

/// How wrong a simulated odometry is: independent errors of velocity and biases in each state.
struct SimulatedOdometry {
  double velocity_sigma = 0.02;       ///< [m/s]
  double gyroscope_sigma = 1e-3;      ///< [rad/s]
  double accelerometer_sigma = 2e-2;  ///< [m/s^2]

  [[nodiscard]] Matrix9d covariance() const {
    Vector9d sigma;
    sigma << Eigen::Vector3d::Constant(velocity_sigma), Eigen::Vector3d::Constant(gyroscope_sigma),
        Eigen::Vector3d::Constant(accelerometer_sigma);
    return sigma.cwiseAbs2().asDiagonal();
  }
};

inline SimulatedRun simulated_run(std::uint64_t seed, bool imu_noise) {
  SimulatedRun::Config config;
  config.seed = seed;
  config.imu_white_noise = imu_noise;
  config.imu_bias_walk = imu_noise;
  return SimulatedRun(config);
}

inline constexpr Duration kKeyframeInterval = std::chrono::milliseconds(500);

inline Timestamp keyframe_stamp(int index) {
  return Timestamp{} + index * kKeyframeInterval;
}

/// Keyframes every half second from the start of the run on.
class SimulatedKeyframes {
 public:
  SimulatedKeyframes(const SimulatedRun& run,
                     const SimulatedOdometry& odometry,
                     int count,
                     std::uint64_t seed)
      : odometry_(odometry) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    const auto draw = [&](double sigma) {
      return Eigen::Vector3d(Eigen::Vector3d::NullaryExpr([&] { return sigma * normal(random); }));
    };
    for (int k = 0; k < count; ++k) {
      truth_.push_back(run.truth(keyframe_stamp(k)));
      NavState state = truth_.back();
      state.v_odom += draw(odometry.velocity_sigma);
      state.bias.gyroscope += draw(odometry.gyroscope_sigma);
      state.bias.accelerometer += draw(odometry.accelerometer_sigma);
      states_.push_back(state);
      if (k > 0) {
        between_.emplace_back(run.imu(keyframe_stamp(k - 1), keyframe_stamp(k)),
                              states_[states_.size() - 2].bias,
                              run.noise());
      }
    }
  }

  [[nodiscard]] const std::vector<NavState>& truth() const { return truth_; }

  [[nodiscard]] InertialWindow window(std::size_t first, std::size_t count) const {
    const auto begin = static_cast<std::ptrdiff_t>(first);
    const auto end = static_cast<std::ptrdiff_t>(first + count);
    return {.states = {states_.begin() + begin, states_.begin() + end},
            .between = {between_.begin() + begin, between_.begin() + end - 1},
            .oldest_covariance = odometry_.covariance()};
  }

 private:
  SimulatedOdometry odometry_;
  std::vector<NavState> truth_;
  std::vector<NavState> states_;
  std::vector<Preintegration> between_;
};

}  // namespace fleetloc
