#pragma once

#include <filesystem>
#include <vector>

#include "robot/dataset/frame_source.hpp"
#include "robot/dataset/stereo_index.hpp"
#include "shared/model/camera.hpp"

namespace fleetloc {

/// The images of cam0 and cam1.
class StereoImages final : public FrameSource {
 public:
  /// Throws DatasetError for what is wrong with the lists of the images.
  StereoImages(const std::filesystem::path& mav0, StereoCalibration calibration);

  [[nodiscard]] const std::vector<Timestamp>& stamps() const override { return stamps_; }
  /// Throws DatasetError for an image that cannot be decoded, or not of its camera's size.
  CameraFrame read(std::size_t index) override;

 private:
  StereoCalibration calibration_;
  std::vector<StereoEntry> entries_;
  std::vector<Timestamp> stamps_;
};

}  // namespace fleetloc
