#pragma once

#include <optional>

#include "shared/config/config_reader.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/model/inertial.hpp"

namespace fleetloc {

/// Detects that the body stands still (zero-velocity detection): the odometry's pose has stayed
/// where it was, and since then the IMU's mean readings, too. It ends with the first reading or
/// pose that has not. In the dark only the IMU can tell.
///
/// Means are compared and not single readings, so that an engine may run. They are compared with
/// those of the standstill itself, which follow slowly, so that biases may walk.
class StandstillDetector {
 public:
  struct Config {
    double begins_after_s = 0.0;  ///< that long the pose must have stayed
    double max_moved_m = 0.0;     ///< of the pose, from where it was when it began
    double max_turned_rad = 0.0;  ///< likewise
    double averaging_s = 0.0;     ///< of the IMU's readings
    double reference_s = 0.0;  ///< over which the readings are averaged that they are compared with
    double max_turn_rate = 0.0;     ///< difference of the two means of the gyroscope [rad/s]
    double max_acceleration = 0.0;  ///< and of the accelerometer [m/s^2]
  };
  explicit StandstillDetector(const Config& config) : config_(config) {}

  /// Stamps increase.
  void add_imu(const ImuSample& sample);

  /// @param T_odom_body  by the odometry at a frame; stamps increase
  /// @param is_seen      its images agree with it; without, it says nothing once the body stands
  /// @return since when the body stands still; nothing: it moves
  std::optional<Timestamp> update(Timestamp stamp, const Pose& T_odom_body, bool is_seen);

  /// It is taken to move, until the pose has stayed again.
  void reset() { began_.reset(); }

 private:
  struct Readings {
    Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();
    Eigen::Vector3d specific_force = Eigen::Vector3d::Zero();

    void approach(const ImuSample& sample, double share);
  };
  struct Begin {
    Timestamp stamp;
    Pose T_odom_body;
  };
  [[nodiscard]] bool has_moved(const Pose& T_odom_body) const;
  void begin(Timestamp stamp, const Pose& T_odom_body);

  Config config_;
  std::optional<Timestamp> last_imu_;
  Readings mean_;
  Readings reference_;
  double reference_time_s_ = 0.0;  // over which it has been averaged
  bool imu_moved_ = false;         // since the last update
  std::optional<Begin> began_;
  bool stands_ = false;
};

StandstillDetector::Config read_standstill_config(ConfigReader section);

}  // namespace fleetloc
