#include "robot/odometry/front_end.hpp"

#include <utility>
#include <variant>
#include <vector>

#include "robot/inertial/preintegration.hpp"

namespace fleetloc {

FrontEnd::FrontEnd(const StereoCalibration& calibration,
                   const ImuNoise& imu_noise,
                   const FeatureTracker::Config& config)
    : calibration_(calibration), imu_noise_(imu_noise), tracker_(calibration, config) {}

TrackedFrame FrontEnd::track(CameraFrame frame, const ImuBuffer& imu, const ImuBias& bias) {
  const Timestamp stamp = stamp_of(frame);
  auto* images = std::get_if<StereoFrame>(&frame);
  if (images != nullptr) {
    check_image(images->left, calibration_.cam0);
    check_image(images->right, calibration_.cam1);
    frame = tracker_.track(*images, predicted_rotation(stamp, imu, bias));
  }
  last_stamp_ = stamp;
  return std::get<TrackedFrame>(std::move(frame));
}

void FrontEnd::check_image(cv::Mat& image, const Camera& camera) {
  if (image.empty()) {
    ++faults_["missing_images"];
  } else if (!is_usable(image, camera)) {
    ++faults_["wrong_images"];
    image = cv::Mat();
  }
}

bool FrontEnd::is_usable(const cv::Mat& image, const Camera& camera) {
  return image.type() == CV_8UC1 && image.cols == camera.width_px && image.rows == camera.height_px;
}

TrackedFrame FrontEnd::peek(CameraFrame frame) const {
  if (auto* images = std::get_if<StereoFrame>(&frame)) {
    if (!is_usable(images->left, calibration_.cam0)) images->left = cv::Mat();
    if (!is_usable(images->right, calibration_.cam1)) images->right = cv::Mat();
    FeatureTracker tracker = tracker_;
    frame = tracker.track(*images, Eigen::Quaterniond::Identity());
  }
  return std::get<TrackedFrame>(std::move(frame));
}

// From the gyroscope alone; identity where the IMU has a gap.
Eigen::Quaterniond FrontEnd::predicted_rotation(Timestamp stamp,
                                                const ImuBuffer& imu,
                                                const ImuBias& bias) const {
  if (!last_stamp_) return Eigen::Quaterniond::Identity();
  const std::vector<ImuSample> samples = imu.between(*last_stamp_, stamp);
  if (samples.size() < 2) return Eigen::Quaterniond::Identity();
  return Preintegration(samples, bias, imu_noise_).deltas(bias).R;
}

}  // namespace fleetloc
