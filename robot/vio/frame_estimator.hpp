#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "robot/inertial/imu_buffer.hpp"
#include "robot/vio/vio_noise.hpp"
#include "robot/vio/window_estimate.hpp"
#include "shared/model/camera.hpp"

namespace fleetloc {

/// A causal pose for every frame: inertial prediction from the newest keyframe of the latest
/// window, refined by reprojection errors of the window's landmarks, which are fixed.
class FrameEstimator {
 public:
  struct Config {
    VioNoise noise;
    int iterations = 0;
    double huber_sigmas = 0.0;
    double outlier_sigmas = 0.0;
    int min_tracked = 0;  ///< observations of known landmarks for a refinement; any, for a keyframe
    double max_correction_chi_square = 0.0;  ///< of the predicted pose by vision, 6 DoF
    double max_outlier_share = 0.0;          ///< of `min_tracked` or more known landmarks
    double keyframe_parallax_px = 0.0;       ///< median, rotation taken out
    double keyframe_tracked_share = 0.0;  ///< of the last keyframe's landmarks; below: new keyframe
    double min_keyframe_interval_s = 0.0;
    double max_keyframe_interval_s = 0.0;
  };
  struct Result {
    OdometryEstimate estimate;
    bool wants_keyframe = false;
    int tracked = 0;                   ///< observations of known landmarks
    std::vector<LandmarkId> outliers;  ///< of these, rejected by the refinement; increasing
    bool vision_updated = false;       ///< false: the estimate is the inertial prediction
    /// Of the correction by vision; beyond the limit the images contradict the IMU, e.g. because
    /// they are old.
    double correction_chi_square = 0.0;
    /// The correction was beyond the limit, or too many landmarks were outliers.
    bool vision_inconsistent = false;
  };

  FrameEstimator(RectifiedStereo stereo, const ImuNoise& noise, const Config& config);

  void update(std::shared_ptr<const WindowEstimate> window);

  /// Forgets window and reference: the odometry was reset.
  void reset();

  /// Nothing before the first window, for a frame before its newest keyframe, and where `imu` does
  /// not reach from there to the frame.
  std::optional<Result> estimate(const TrackedFrame& frame, const ImuBuffer& imu);

  /// After a frame became a keyframe: later frames are compared with it to select the next one,
  /// before the window contains it.
  void set_reference_keyframe(const TrackedFrame& frame, const NavState& state);

 private:
  // What the next frames are compared with: the last frame that became a keyframe.
  struct Reference {
    TrackedFrame frame;
    Eigen::Quaterniond R_odom_body;
  };
  [[nodiscard]] bool wants_keyframe(const TrackedFrame& frame,
                                    const Eigen::Quaterniond& R_odom_body) const;

  RectifiedStereo stereo_;
  ImuNoise noise_;  // inflated
  Config config_;
  std::shared_ptr<const WindowEstimate> window_;
  std::optional<Reference> reference_;
};
FrameEstimator::Config read_frame_estimator_config(ConfigReader section, const VioNoise& noise);

}  // namespace fleetloc
