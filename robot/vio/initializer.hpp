#pragma once

#include <optional>
#include <span>
#include <vector>

#include "robot/vio/inertial_alignment.hpp"
#include "robot/vio/sliding_window.hpp"
#include "robot/vio/stereo_odometry.hpp"

namespace fleetloc {

/// Finds the first states of the sliding window, at rest or in motion: stereo odometry without the
/// IMU, the gyroscope's bias from its rotations, then gravity, velocities and the accelerometer's
/// bias by linear alignment with |g| known, refined by one optimization of all keyframes.
///
/// odom: origin at the body of the first frame of the aligned segment, its axes turned by the
/// shortest rotation that makes z point up. Keyframes count from 0. After a loss of vision, or a
/// gap of the IMU, a new segment begins. After success the next frame begins the next
/// initialization.
class Initializer {
 public:
  struct Config {
    SlidingWindow::Config window;
    StereoOdometry::Config odometry;
    double duration_s = 0.0;              ///< of the aligned segment
    double keyframe_interval_s = 0.0;     ///< within it, at least
    double position_sigma_m = 0.0;        ///< of the stereo odometry, between keyframes
    double max_gravity_error = 0.0;       ///< | |g| - 9.81 | when |g| is left free [m/s^2]
    double max_gyroscope_bias = 0.0;      ///< [rad/s]
    double max_accelerometer_bias = 0.0;  ///< [m/s^2]
    double max_cost_per_residual = 0.0;   ///< of the refined window; 0.5 is expected
  };

  /// Result of the last attempt.
  enum class Status {
    kCollecting,
    kVisionLost,
    kWrongGravity,
    kWrongBias,
    kResiduals,
    kInitialized
  };

  Initializer(const RectifiedStereo& stereo, const ImuNoise& noise, const Config& config);

  /// @param since_previous_frame  from the previous frame's stamp to this one's, ends interpolated;
  ///        empty for the first, or where the IMU has a gap. Samples that do not begin at the stamp
  ///        of the previous frame count as a gap, too.
  std::optional<Initialization> add(const TrackedFrame& frame,
                                    std::span<const ImuSample> since_previous_frame);

  [[nodiscard]] Status status() const { return status_; }

 private:
  struct Frame {
    TrackedFrame frame;
    std::vector<ImuSample> imu;  // since the previous frame
    Pose T_first_body;           // by stereo odometry
  };
  void restart();
  [[nodiscard]] bool continues(std::span<const ImuSample> since_previous_frame) const;
  [[nodiscard]] std::vector<std::size_t> choose_keyframes() const;
  std::optional<Initialization> align();
  [[nodiscard]] Status check(const InertialAlignment& alignment) const;
  [[nodiscard]] bool plausible(const ImuBias& bias) const;
  [[nodiscard]] Status refine(Initialization& initialization) const;

  RectifiedStereo stereo_;
  ImuNoise noise_;
  Config config_;
  StereoOdometry odometry_;
  std::vector<Frame> frames_;
  bool starts_at_first_frame_ = true;  // the odometry starts at the first frame that was added
  Status status_ = Status::kCollecting;
};
Initializer::Config read_initializer_config(ConfigReader section,
                                            const SlidingWindow::Config& window);

}  // namespace fleetloc
