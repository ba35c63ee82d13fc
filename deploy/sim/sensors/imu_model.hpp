#pragma once

#include <cstdint>
#include <vector>

#include "deploy/sim/motion/spline_motion.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/model/inertial.hpp"

namespace fleetloc {

/// Error model of an IMU. Constant errors are drawn by the seed, with the sigmas given.
struct ImuModelConfig {
  double rate_hz = 200.0;
  ImuNoise noise;
  double initial_gyroscope_bias = 0.0;      ///< sigma of each axis [rad/s]
  double initial_accelerometer_bias = 0.0;  ///< sigma of each axis [m/s^2]
  double scale_error = 0.0;                 ///< sigma of each axis of both sensors, relative
  double misalignment = 0.0;  ///< sigma of each off-diagonal element of both sensors [rad]
};

/// Throws ConfigError.
ImuModelConfig read_imu_model_config(ConfigReader section);

/// Samples, and the bias that was in each.
struct ImuRecord {
  std::vector<ImuSample> samples;
  std::vector<ImuBias> biases;
};

/// The motion as an IMU measures it, from its start to its end. A sample is
///   (I + S) x + bias + white noise,   x = angular velocity, or R^T (a - g),
/// where S has the scale errors on its diagonal and the misalignments (between axes, and between
/// sensor and body) beside it; white noise has density * sqrt(rate), and the bias makes a step of
/// walk / sqrt(rate) before each sample but the first (ImuNoise's units).
///
/// x is that of a unit that integrates internally: the mean of two successive values is the mean
/// rate between them (to fourth order of the interval, the turning of the axes included), so that
/// whoever integrates by the midpoint rule, as robot/inertial does, gets the motion back. The value
/// at the instant itself would differ by less than 1e-5 of the rates of a ground robot, yet the
/// attitude error of the midpoint rule would amount to 4 mm after 10 s of vibration; the mean over
/// the last interval would be late by half of it. Deterministic by the seed; each source of error
/// has random numbers of its own.
/// @param start  stamp of the motion's time zero
ImuRecord measured_imu(const SplineMotion& motion,
                       const ImuModelConfig& config,
                       Timestamp start,
                       std::uint64_t seed);

}  // namespace fleetloc
