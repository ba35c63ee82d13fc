#include "deploy/sim/room/room_trajectory.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <span>

namespace fleetloc {
namespace {

constexpr double kSpeedUpTime = 2.0;  // [s]

struct Sine {
  double amplitude;  // [m] or [rad]
  int harmonic;      // per round: the curve closes
  double phase;      // [rad]
};

// Slow terms are the path, fast ones the shaking of a flying robot.
constexpr double kQuarter = 0.5 * std::numbers::pi;
constexpr std::array kX{
    Sine{3.0, 1, kQuarter}, Sine{0.30, 3, 0.4}, Sine{0.020, 11, 1.0}, Sine{0.006, 23, 0.2}};
constexpr std::array kY{
    Sine{2.2, 1, 0.0}, Sine{0.25, 2, 1.1}, Sine{0.020, 10, 2.0}, Sine{0.006, 21, 0.7}};
constexpr std::array kZ{
    Sine{0.35, 2, 0.3}, Sine{0.10, 5, 2.2}, Sine{0.020, 12, 0.5}, Sine{0.006, 25, 1.9}};
constexpr double kHeight = 1.7;  // [m]
constexpr std::array kYaw{Sine{0.25, 2, 0.9}, Sine{0.05, 7, 2.5}, Sine{0.004, 19, 0.1}};
constexpr std::array kPitch{Sine{0.10, 3, 1.7}, Sine{0.04, 8, 0.6}, Sine{0.004, 17, 2.1}};
constexpr std::array kRoll{Sine{0.12, 2, 2.6}, Sine{0.04, 9, 1.3}, Sine{0.004, 22, 0.8}};
constexpr double kYawInwards = 0.3;  // from the direction of travel to the middle of the room [rad]

// A function of the curve's parameter or of time, with two derivatives.
struct Jet {
  double value = 0.0;
  double first = 0.0;
  double second = 0.0;
};

Jet sum(std::span<const Sine> sines, double theta) {
  Jet jet;
  for (const Sine& sine : sines) {
    const double k = sine.harmonic;
    const double angle = k * theta + sine.phase;
    jet.value += sine.amplitude * std::sin(angle);
    jet.first += sine.amplitude * k * std::cos(angle);
    jet.second -= sine.amplitude * k * k * std::sin(angle);
  }
  return jet;
}

// Mean square of the derivative over a round; sines of different harmonics are orthogonal.
double mean_square_slope(std::span<const Sine> sines) {
  double mean = 0.0;
  for (const Sine& sine : sines) {
    mean += 0.5 * std::pow(sine.amplitude * sine.harmonic, 2);
  }
  return mean;
}

// outer(inner(t)) by the chain rule.
Jet chain(const Jet& outer, const Jet& inner) {
  return {outer.value,
          outer.first * inner.first,
          outer.second * inner.first * inner.first + outer.first * inner.second};
}

// Time in motion: at rest until zero, then up to speed with continuous acceleration and jerk.
Jet speeding_up(double time_s) {
  const double u = time_s / kSpeedUpTime;
  if (u <= 0.0) {
    return {};
  }
  if (u >= 1.0) {
    return {kSpeedUpTime * (u - 0.5), 1.0, 0.0};
  }
  return {kSpeedUpTime * u * u * u * u * (2.5 + u * (u - 3.0)),
          u * u * u * (10.0 + u * (6.0 * u - 15.0)),
          30.0 * u * u * (1.0 - u) * (1.0 - u) / kSpeedUpTime};
}

// At rest first. A stop begins with the speeding up backwards in time.
Jet time_in_motion(double time_s, double rest_s, const RoomTrajectory::Stop& stop) {
  const auto before_stop = [rest_s](double t) {
    return rest_s <= 0.0 ? Jet{t, 1.0, 0.0} : speeding_up(t - rest_s);
  };
  if (time_s <= stop.at_s || stop.stands_s <= 0.0) return before_stop(time_s);
  const double since_stop = time_s - stop.at_s;
  const double stopped = before_stop(stop.at_s).value + speeding_up(kSpeedUpTime).value;
  if (since_stop < kSpeedUpTime) {
    const Jet left = speeding_up(kSpeedUpTime - since_stop);
    return {stopped - left.value, left.first, -left.second};
  }
  const Jet on = speeding_up(since_stop - kSpeedUpTime - stop.stands_s);
  return {stopped + on.value, on.first, on.second};
}

// From a vehicle's axes (x forward, y left, z up) to EuRoC's IMU (x up, y right, z forward).
Eigen::Matrix3d vehicle_from_body() {
  Eigen::Matrix3d R;
  R << 0.0, 0.0, 1.0,  //
      0.0, -1.0, 0.0,  //
      1.0, 0.0, 0.0;
  return R;
}

// Rates of yaw, then pitch, then roll about the moving axes, in vehicle axes.
Eigen::Vector3d vehicle_rates(const Jet& yaw, const Jet& pitch, const Jet& roll) {
  const double cos_pitch = std::cos(pitch.value);
  const double sin_roll = std::sin(roll.value);
  const double cos_roll = std::cos(roll.value);
  return {roll.first - yaw.first * std::sin(pitch.value),
          pitch.first * cos_roll + yaw.first * sin_roll * cos_pitch,
          -pitch.first * sin_roll + yaw.first * cos_roll * cos_pitch};
}

}  // namespace

RoomTrajectory::RoomTrajectory(double rest_s, double speed, const Stop& stop)
    : rest_s_(rest_s),
      stop_(stop),
      rounds_rate_(speed / std::sqrt(mean_square_slope(kX) + mean_square_slope(kY) +
                                     mean_square_slope(kZ))) {}

double RoomTrajectory::round_s() const {
  return 2.0 * std::numbers::pi / rounds_rate_;
}

Motion RoomTrajectory::at(double time_s) const {
  Jet theta = time_in_motion(time_s, rest_s_, stop_);
  theta = {rounds_rate_ * theta.value, rounds_rate_ * theta.first, rounds_rate_ * theta.second};
  const auto along = [&](std::span<const Sine> sines) {
    return chain(sum(sines, theta.value), theta);
  };

  const Jet x = along(kX);
  const Jet y = along(kY);
  const Jet z = along(kZ);
  Jet yaw = along(kYaw);
  yaw.value += theta.value + kQuarter + kYawInwards;  // along a circle
  yaw.first += theta.first;
  const Jet pitch = along(kPitch);
  const Jet roll = along(kRoll);

  const Eigen::Quaterniond R_room_vehicle =
      Eigen::AngleAxisd(yaw.value, Eigen::Vector3d::UnitZ()) *
      Eigen::AngleAxisd(pitch.value, Eigen::Vector3d::UnitY()) *
      Eigen::AngleAxisd(roll.value, Eigen::Vector3d::UnitX());
  const Eigen::Matrix3d R_vehicle_body = vehicle_from_body();

  Motion motion;
  motion.T_room_body.R = R_room_vehicle * Eigen::Quaterniond(R_vehicle_body);
  motion.T_room_body.p = {x.value, y.value, kHeight + z.value};
  motion.v_room = {x.first, y.first, z.first};
  motion.a_room = {x.second, y.second, z.second};
  motion.angular_velocity = R_vehicle_body.transpose() * vehicle_rates(yaw, pitch, roll);
  return motion;
}

}  // namespace fleetloc
