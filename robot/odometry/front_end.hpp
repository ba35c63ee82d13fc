#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "robot/inertial/imu_buffer.hpp"
#include "robot/tracking/feature_tracker.hpp"
#include "shared/model/camera.hpp"
#include "shared/model/camera_frame.hpp"
#include "shared/model/inertial.hpp"

namespace fleetloc {

/// From the cameras' frames to feature tracks, with the gyroscope's help.
class FrontEnd {
 public:
  FrontEnd(const StereoCalibration& calibration,
           const ImuNoise& imu_noise,
           const FeatureTracker::Config& config);

  /// A missing image, or one not of the calibrated size, is ignored and counted. Tracks of a
  /// simulation or a recording are passed on.
  /// @param imu  covers the stamps of this frame and, unless there is a gap, of the one before
  /// @param bias  of the IMU, as far as it is known
  TrackedFrame track(CameraFrame frame, const ImuBuffer& imu, const ImuBias& bias);

  /// What track() would give, while the body does not turn; nothing is changed or counted.
  [[nodiscard]] TrackedFrame peek(CameraFrame frame) const;

  /// Of the last frame that was tracked.
  [[nodiscard]] std::optional<Timestamp> last_stamp() const { return last_stamp_; }

  /// Counts by kind: "missing_images", "wrong_images".
  [[nodiscard]] const std::map<std::string, std::uint64_t>& faults() const { return faults_; }

 private:
  void check_image(cv::Mat& image, const Camera& camera);
  [[nodiscard]] static bool is_usable(const cv::Mat& image, const Camera& camera);
  [[nodiscard]] Eigen::Quaterniond predicted_rotation(Timestamp stamp,
                                                      const ImuBuffer& imu,
                                                      const ImuBias& bias) const;

  StereoCalibration calibration_;
  ImuNoise imu_noise_;
  FeatureTracker tracker_;
  std::optional<Timestamp> last_stamp_;
  std::map<std::string, std::uint64_t> faults_ = {{"missing_images", 0}, {"wrong_images", 0}};
};

}  // namespace fleetloc
