#pragma once

#include <map>
#include <optional>

#include "shared/config/config_reader.hpp"
#include "shared/model/camera.hpp"
#include "shared/model/observation.hpp"

namespace fleetloc {

/// Pose from frame to frame without the IMU: landmarks are triangulated from the first stereo pair
/// that sees them and then fixed; each new frame is aligned to those it sees by robust
/// Gauss-Newton.
class StereoOdometry {
 public:
  struct Config {
    double pixel_sigma = 0.0;       ///< [px]
    double min_disparity_px = 0.0;  ///< of a landmark
    double huber_sigmas = 0.0;
    double outlier_sigmas = 0.0;
    int iterations = 0;
    int min_inliers = 0;
  };
  StereoOdometry(RectifiedStereo stereo, const Config& config);

  /// Body relative to the body at the first frame; nothing if there are too few inliers; the state
  /// is then unchanged.
  std::optional<Pose> add(const TrackedFrame& frame);

 private:
  [[nodiscard]] std::optional<Pose> align(const TrackedFrame& frame) const;

  RectifiedStereo stereo_;
  Config config_;
  bool started_ = false;
  Pose T_first_last_;
  Pose T_before_last_;                               // the last step, which predicts the next one
  std::map<LandmarkId, Eigen::Vector3d> landmarks_;  // in the first body frame
};
StereoOdometry::Config read_stereo_odometry_config(ConfigReader section, double pixel_sigma);

}  // namespace fleetloc
