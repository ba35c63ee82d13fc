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
  } else if (image.type() != CV_8UC1 || image.cols != camera.width_px ||
             image.rows != camera.height_px) {
    ++faults_["wrong_images"];
    image = cv::Mat();
  }
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
