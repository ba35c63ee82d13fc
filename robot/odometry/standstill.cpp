#include "robot/odometry/standstill.hpp"

#include <algorithm>

#include "shared/geometry/angle.hpp"
#include "shared/geometry/so3.hpp"

namespace fleetloc {

void StandstillDetector::Readings::approach(const ImuSample& sample, double share) {
  angular_velocity += share * (sample.angular_velocity - angular_velocity);
  specific_force += share * (sample.specific_force - specific_force);
}

void StandstillDetector::add_imu(const ImuSample& sample) {
  const double dt = last_imu_ ? to_seconds(sample.stamp - *last_imu_) : config_.averaging_s;
  last_imu_ = sample.stamp;
  mean_.approach(sample, std::min(1.0, dt / config_.averaging_s));
  reference_time_s_ += dt;
  reference_.approach(sample, std::min(1.0, dt / std::min(reference_time_s_, config_.reference_s)));
  const double turn_rate = (mean_.angular_velocity - reference_.angular_velocity).norm();
  const double acceleration = (mean_.specific_force - reference_.specific_force).norm();
  // NaN counts as motion.
  if (!(turn_rate <= config_.max_turn_rate) || !(acceleration <= config_.max_acceleration)) {
    imu_moved_ = true;
  }
}

std::optional<Timestamp> StandstillDetector::update(Timestamp stamp,
                                                    const Pose& T_odom_body,
                                                    bool is_seen) {
  const bool by_pose = (is_seen || !stands_) && has_moved(T_odom_body);
  if (!began_ || imu_moved_ || by_pose) begin(stamp, T_odom_body);
  stands_ = to_seconds(stamp - began_->stamp) >= config_.begins_after_s;
  if (!stands_) return std::nullopt;
  return began_->stamp;
}

bool StandstillDetector::has_moved(const Pose& T_odom_body) const {
  if (!began_) return true;
  const double moved_m = (T_odom_body.p - began_->T_odom_body.p).norm();
  const double turned_rad = log_so3(began_->T_odom_body.R.conjugate() * T_odom_body.R).norm();
  return !(moved_m <= config_.max_moved_m) || !(turned_rad <= config_.max_turned_rad);
}

void StandstillDetector::begin(Timestamp stamp, const Pose& T_odom_body) {
  began_ = {stamp, T_odom_body};
  reference_ = mean_;
  reference_time_s_ = config_.averaging_s;
  imu_moved_ = false;
}

StandstillDetector::Config read_standstill_config(ConfigReader section) {
  StandstillDetector::Config config;
  config.begins_after_s = section.positive("begins_after_s");
  config.max_moved_m = section.positive("max_moved_m");
  config.max_turned_rad = kRadPerDeg * section.positive("max_turned_deg");
  config.averaging_s = section.positive("averaging_s");
  config.reference_s = section.positive("reference_s");
  config.max_turn_rate = section.positive("max_turn_rate");
  config.max_acceleration = section.positive("max_acceleration");
  return config;
}

}  // namespace fleetloc
