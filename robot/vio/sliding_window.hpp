#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "robot/vio/vio_noise.hpp"
#include "robot/vio/window_estimate.hpp"
#include "shared/model/camera.hpp"
#include "shared/model/correction.hpp"

namespace fleetloc {

struct KeyframeInput {
  KeyframeId id{};
  TrackedFrame frame;
  /// From the previous keyframe's stamp to this one's, ends interpolated; empty for the first.
  std::vector<ImuSample> imu;
  Duration standstill{};  ///< time that `imu` leaves out, since the body stood still
  /// The newest that has arrived since the previous keyframe, of the same session.
  std::optional<Correction> correction = std::nullopt;
  bool forgets_corrections = false;  ///< all before this one: of a place that has been given up
};

/// Initial states of a window; see Initializer.
struct Initialization {
  std::vector<KeyframeInput> keyframes;
  std::vector<NavState> states;  ///< of the keyframes
  /// Body at the newest keyframe relative to the body at the first frame that the initializer was
  /// given; nothing where vision or IMU failed in between: that motion was not observed.
  std::optional<Pose> T_first_newest = std::nullopt;
  /// Covariance of the oldest keyframe's yaw and position in odom: not zero where odom goes on from
  /// an earlier window.
  Eigen::Matrix4d drift = Eigen::Matrix4d::Zero();
};

/// Optimizes the states of the latest keyframes and their landmarks (paper, eq. 4; with corrections
/// eq. 11): reprojection (eq. 1), preintegration (eq. 2), random walk of the biases (eq. 3) and the
/// marginalization prior. Only yaw and position of the oldest keyframe are fixed.
class SlidingWindow {
 public:
  struct Config {
    VioNoise noise;
    int keyframes = 0;                      ///< in the window, the newest included
    int iterations = 0;                     ///< of one optimization, at most
    double huber_sigmas = 0.0;              ///< of a whole reprojection error, in pixel sigmas
    double outlier_sigmas = 0.0;            ///< likewise: observations beyond it are dropped
    double min_disparity_px = 0.0;          ///< for a landmark from one stereo pair
    double max_depth_m = 0.0;               ///< landmarks farther away are not used
    double gyroscope_bias_sigma = 0.0;      ///< at the start, about zero [rad/s]
    double accelerometer_bias_sigma = 0.0;  ///< at the start, about zero [m/s^2]
    bool merge = false;                     ///< the cloud's corrections; else only count them
  };

  SlidingWindow(const RectifiedStereo& stereo,
                const ImuNoise& noise,
                const Config& config,
                const Initialization& initialization);
  ~SlidingWindow();
  SlidingWindow(const SlidingWindow& other) = delete;
  SlidingWindow& operator=(const SlidingWindow& other) = delete;
  SlidingWindow(SlidingWindow&& other) noexcept;
  SlidingWindow& operator=(SlidingWindow&& other) noexcept;

  /// As of the last optimization.
  [[nodiscard]] const WindowEstimate& estimate() const;

  /// Optimizes with the new keyframe, then marginalizes the oldest one if the window is full.
  WindowEstimate add(const KeyframeInput& keyframe);

 private:
  struct State;
  std::unique_ptr<State> state_;
};
SlidingWindow::Config read_sliding_window_config(ConfigReader section, const VioNoise& noise);

}  // namespace fleetloc
