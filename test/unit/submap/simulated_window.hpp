#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "robot/inertial/inertial_window.hpp"
#include "shared/simulation/simulated_run.hpp"

namespace fleetloc {

/// What a simulated odometry believes of velocity and biases: the truth with errors that keep
/// their variance, and are correlated in time like those of a window that slides.
struct SimulatedOdometry {
  double velocity_sigma = 0.02;         ///< [m/s]
  double gyroscope_sigma = 1e-3;        ///< [rad/s]
  double accelerometer_sigma = 2e-2;    ///< [m/s^2]
  double velocity_correlation_s = 0.0;  ///< time constant of a Gauss-Markov process
  double bias_correlation_s = 0.0;

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
    const double dt = to_seconds(kKeyframeInterval);
    const auto kept = [dt](double time) { return time > 0.0 ? std::exp(-dt / time) : 0.0; };
    NavState error;  // of velocity and biases
    for (int k = 0; k < count; ++k) {
      const double v = k == 0 ? 0.0 : kept(odometry.velocity_correlation_s);
      const double b = k == 0 ? 0.0 : kept(odometry.bias_correlation_s);
      error.v_odom = v * error.v_odom + draw(std::sqrt(1 - v * v) * odometry.velocity_sigma);
      error.bias.gyroscope =
          b * error.bias.gyroscope + draw(std::sqrt(1 - b * b) * odometry.gyroscope_sigma);
      error.bias.accelerometer =
          b * error.bias.accelerometer + draw(std::sqrt(1 - b * b) * odometry.accelerometer_sigma);
      truth_.push_back(run.truth(keyframe_stamp(k)));
      NavState state = truth_.back();
      state.v_odom += error.v_odom;
      state.bias.gyroscope += error.bias.gyroscope;
      state.bias.accelerometer += error.bias.accelerometer;
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
