#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "robot/vio/inertial_alignment.hpp"
#include "robot/vio/sliding_window.hpp"
#include "robot/vio/stereo_odometry.hpp"
#include "shared/core/expected.hpp"

namespace fleetloc {

/// Why there is no initialization yet.
enum class NotInitialized {
  kCollecting,          ///< the segment is still too short
  kVisionLost,          ///< the stereo odometry: a new segment begins
  kImplausibleGravity,  ///< |g|, when it is left free
  kImplausibleBias,     ///< of the IMU: above its limit
  kResiduals,           ///< the refined window does not explain what was measured
};

/// Name in files, e.g. "implausible_gravity".
std::string_view name(NotInitialized reason);

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

  Initializer(const RectifiedStereo& stereo, const ImuNoise& noise, const Config& config);

  /// @param since_previous_frame  from the previous frame's stamp to this one's, ends interpolated;
  ///        empty for the first, or where the IMU has a gap. Samples that do not begin at the stamp
  ///        of the previous frame count as a gap, too.
  expected<Initialization, NotInitialized> add(const TrackedFrame& frame,
                                               std::span<const ImuSample> since_previous_frame);

  /// As newly constructed: the odometry was reset.
  void reset();

 private:
  struct Frame {
    TrackedFrame frame;
    std::vector<ImuSample> imu;  // since the previous frame
    Pose T_first_body;           // by stereo odometry
  };
  void restart();
  [[nodiscard]] bool continues(std::span<const ImuSample> since_previous_frame) const;
  [[nodiscard]] std::vector<std::size_t> choose_keyframes() const;
  [[nodiscard]] expected<Initialization, NotInitialized> align() const;
  [[nodiscard]] expected<void, NotInitialized> check(const InertialAlignment& alignment) const;
  [[nodiscard]] bool plausible(const ImuBias& bias) const;
  [[nodiscard]] expected<Initialization, NotInitialized> refined(
      Initialization initialization) const;

  RectifiedStereo stereo_;
  ImuNoise noise_;
  Config config_;
  StereoOdometry odometry_;
  std::vector<Frame> frames_;
  bool starts_at_first_frame_ = true;  // the odometry starts at the first frame that was added
};
Initializer::Config read_initializer_config(ConfigReader section,
                                            const SlidingWindow::Config& window);

}  // namespace fleetloc
