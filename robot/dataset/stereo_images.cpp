#include "robot/dataset/stereo_images.hpp"

#include <string>
#include <utility>

#include "robot/dataset/image_file.hpp"
#include "shared/core/cpu_time.hpp"
#include "shared/dataset/dataset_error.hpp"

namespace fleetloc {
namespace {

cv::Mat load(const ImageEntry& entry, const Camera& camera) {
  cv::Mat image;
  try {
    image = read_image(entry.file);
  } catch (const DatasetError& error) {
    throw DatasetError(entry.where + ": " + error.what());
  }
  if (image.size() != cv::Size(camera.width_px, camera.height_px)) {
    throw DatasetError(entry.where + ": " + entry.file.string() + ": has " +
                       std::to_string(image.cols) + "x" + std::to_string(image.rows) +
                       " pixels instead of the sensor's " + std::to_string(camera.width_px) + "x" +
                       std::to_string(camera.height_px));
  }
  return image;
}

}  // namespace

StereoImages::StereoImages(const std::filesystem::path& mav0, StereoCalibration calibration)
    : calibration_(std::move(calibration)),
      entries_(pair_images(read_image_list(mav0 / "cam0"), read_image_list(mav0 / "cam1"))) {
  for (const StereoEntry& entry : entries_) stamps_.push_back(entry.stamp);
}

CameraFrame StereoImages::read(std::size_t index) {
  const StereoEntry& entry = entries_[index];
  StereoFrame frame;
  const Duration begin = thread_cpu_time();
  frame.stamp = entry.stamp;
  if (entry.left) frame.left = load(*entry.left, calibration_.cam0);
  if (entry.right) frame.right = load(*entry.right, calibration_.cam1);
  frame.decoding_cpu = thread_cpu_time() - begin;
  return frame;
}

}  // namespace fleetloc
